// SPDX-License-Identifier: Apache-2.0
// Cull answer `none`: every batch goes into every view.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shadows/cull/cull.glsl"

bool survives(ShadowView view, BatchInstance candidate) { return true; }
