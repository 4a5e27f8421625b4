// SPDX-License-Identifier: Apache-2.0
// One binding of each kind, out of order and with gaps, for the test of what is read from a shader's SPIR-V.
#version 460
#extension GL_EXT_scalar_block_layout : require

struct Pair {
  vec2 both;
  uint last;
};
layout(local_size_x = 8, local_size_y = 4) in;
layout(binding = 7, scalar) readonly buffer Words { uint words[]; };
layout(binding = 5) uniform sampler2D picture;
layout(binding = 2, rgba8) uniform writeonly image2D target;
layout(binding = 3) uniform Block { vec4 scale; };
layout(binding = 0, scalar) buffer Sums { uint sums[]; } named;
layout(binding = 9, scalar) buffer Idle { uint idle[]; };  // declared alone
layout(push_constant, scalar) uniform Push {
  vec3 a;
  uint b[3];
  Pair c[2];
} push;

void main() {
  vec4 color = scale * texture(picture, push.a.xy) * float(words[push.b[1]] + push.c[1].last);
  imageStore(target, ivec2(gl_GlobalInvocationID.xy), color);
  atomicAdd(named.sums[0], 1u);
}
