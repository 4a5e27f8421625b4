// SPDX-License-Identifier: Apache-2.0
// Lookup answer `all`: every pixel tries every light.
uint first_light_all() { return group.first_light; }
uint light_after_all(uint light) { return light + 1u; }
