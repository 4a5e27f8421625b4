// SPDX-License-Identifier: Apache-2.0
// Opaque casters, into squares of layers.
#version 460
#extension GL_GOOGLE_include_directive : require
#define PLACED
#include "shadows/raster/caster.glsl"
