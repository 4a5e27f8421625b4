// SPDX-License-Identifier: Apache-2.0
// The g-buffer with several samples in a pixel: shaded once for each triangle and pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(constant_id = 0) const uint samples = 4u;
#define MULTISAMPLED
#include "shading/g_buffer.glsl"
