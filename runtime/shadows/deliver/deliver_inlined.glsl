// SPDX-License-Identifier: Apache-2.0
// Deliver answer `inline`: shading reads the shadow maps itself.
float delivered_inlined(ShadowMap map, Receiver receiver, uvec2 pixel) { return visibility(map, receiver); }
