// SPDX-License-Identifier: Apache-2.0
// What the radiance image's alpha holds from the g-buffer pass on: 0 where the colour is what the screen shall show
// (KHR_materials_unlit), else 1 + the material's occlusion, from 0 (closed in) to 1 (open). With several samples in
// a pixel, below 1: the part of it that shows no unlit surface. The same in shading/occlusion.h.
#ifndef CHANDELIER_OCCLUSION_GLSL
#define CHANDELIER_OCCLUSION_GLSL

const float UNLIT_ALPHA = 0.0;

float alpha_of_occlusion(float occlusion) { return 1.0 + occlusion; }

bool is_unlit(float alpha) { return alpha == UNLIT_ALPHA; }

#endif
