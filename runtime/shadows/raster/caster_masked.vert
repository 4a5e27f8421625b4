// SPDX-License-Identifier: Apache-2.0
// Casters with an alpha test.
#version 460
#extension GL_GOOGLE_include_directive : require
#define MASKED
#include "shadows/raster/caster.glsl"
