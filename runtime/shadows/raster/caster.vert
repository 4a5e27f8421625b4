// SPDX-License-Identifier: Apache-2.0
// Opaque casters: positions only.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/raster/caster.glsl"
