// SPDX-License-Identifier: Apache-2.0
// Taps of a disc, written once for both projections: included with DISC as CubeDisc and as CascadeDisc.

// Of so many taps, a multiple of four. Where they disagree, once more for each surface that is found beside.
Lit lit_by_taps(DISC disc, mat2x3 axes, float radius_m, uint taps) {
  TapSums sums;
  bool again = false;
  uint pass = 0u;
  do {
    sums = NO_TAPS;
    vec2 turn = vec2(1.0, 0.0);
    uint i = 0u;
    do {
      for (uint k = 0u; k < 4u; ++k, ++i) {
        Tap tap = tap_at(disc, radius_m * tap_ring(i, taps) * turn);
        add_tap(sums, lit(disc, tap), turn, 2u * i >= taps);
        turn = NEXT_TURN * turn;
      }
    } while (i < taps);
    again = false;
    if (sums.lit > 0.0 && sums.lit < float(taps) && pass < MOST_BESIDE) {
      Verdict verdict = verdict_of(disc, way_to_lit(sums, taps), radius_m);
      if (verdict.hidden && disc.lone) sums = NO_TAPS;
      disc.beside = verdict.beside;
      again = verdict.again;
    }
    ++pass;
  } while (again);
  return lit_disc(sums, taps, axes, radius_m);
}

Blockers blockers_of_taps(DISC disc, float search_m) {
  uint count = 0u;
  float sum = 0.0;
  vec2 turn = vec2(1.0, 0.0);
  for (uint i = 0u; i < DISC_TAPS; ++i) {
    Tap tap = tap_at(disc, search_m * tap_ring(i, DISC_TAPS) * turn);
    turn = NEXT_TURN * turn;
    float blocker = depth_at(disc, tap);
    bool blocks = blocker > tap.compared;
    count += blocks ? 1u : 0u;
    sum += blocks ? blocker_place(disc, tap, blocker) : 0.0;
  }
  return Blockers(count, sum, DISC_TAPS);
}
