/* SPDX-License-Identifier: Apache-2.0
 * The preview from C, by the library that programs load: two lamps share a map, the third keeps its own. */
#include <stdio.h>

#include "preview/chandelier_preview.h"

int main(void) {
  const float positions[3][3] = {{0, 0, 0}, {0.2f, 0, 0}, {9, 0, 0}};
  uint32_t centers[3];
  char error[256];
  ChandelierPreviewLights lights = {
      .struct_bytes = sizeof lights, .count = 3, .position = {positions, sizeof positions[0]}};
  ChandelierPreviewCamera camera = {.struct_bytes = sizeof camera, .sees_all = 1};
  ChandelierPreviewResult result = {.struct_bytes = sizeof result, .capacity = 3, .center_of_light = centers};
  ChandelierPreviewSettings settings;
  chandelier_preview_defaults(&settings);
  const int32_t status = chandelier_preview_select(&lights, &settings, &camera, &result, error, sizeof error);
  if (chandelier_preview_abi() != CHANDELIER_PREVIEW_ABI || status != CHANDELIER_PREVIEW_OK) {
    fprintf(stderr, "status %d: %s\n", (int)status, error);
    return 1;
  }
  printf("%u maps: %u %u %u\n", result.bill.shadow_maps, centers[0], centers[1], centers[2]);
  return result.bill.shadow_maps == 2 && centers[0] == 0 && centers[1] == 0 && centers[2] == 2 ? 0 : 1;
}
