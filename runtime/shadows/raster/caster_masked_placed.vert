// SPDX-License-Identifier: Apache-2.0
// Casters with an alpha test, into squares of layers.
#version 460
#extension GL_GOOGLE_include_directive : require
#define MASKED
#define PLACED
#include "shadows/raster/caster.glsl"
