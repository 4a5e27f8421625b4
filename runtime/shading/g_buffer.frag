// SPDX-License-Identifier: Apache-2.0
// The g-buffer with one sample in a pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shading/g_buffer.glsl"
