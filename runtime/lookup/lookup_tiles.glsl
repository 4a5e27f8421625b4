// SPDX-License-Identifier: Apache-2.0
// Lookup answer `tiles`: the lights whose bits lookup/tiles.comp has set. The same for all threads of a work group, so that the
// group runs one loop: groups never reach over a tile's edge.
#ifndef CHANDELIER_LOOKUP_TILES_GLSL
#define CHANDELIER_LOOKUP_TILES_GLSL

// The tile that this work group's pixels are in, in tiles.
uvec2 tile_of_group();

// The first light from `light` on.
uint light_of_tile(uint light) {
  uvec2 tile = tile_of_group();
  uint first_word = (tile.y * group.tiles_x + tile.x) * group.words_per_tile;
  while (light < group.light_end) {
    uint bits = tile_words[first_word + light / 32u].bits >> (light % 32u);
    if (bits != 0u) return min(light + findLSB(bits), group.light_end);
    light = (light / 32u + 1u) * 32u;
  }
  return group.light_end;
}

uint first_light_tiles() { return light_of_tile(group.first_light); }
uint light_after_tiles(uint light) { return light_of_tile(light + 1u); }

#endif
