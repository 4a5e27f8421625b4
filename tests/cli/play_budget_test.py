# SPDX-License-Identifier: Apache-2.0
# Asks chandelier-play what a frame will take, and to keep a budget.
import json
import os
import re

from play_tool import LIGHTS, PlayTest, SMALL, main, schema_validator


class Predict(PlayTest):
    """--predict and budgets; that predictions come true is tested on whole scenes, in tests/scenes."""

    def predict(self, *arguments):
        done = self.play(self.pack, "--predict", "--stats", "p.json", *SMALL, *arguments,
                         env={**os.environ, "VK_DRIVER_FILES": "/nowhere.json"})
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads((self.folder / "p.json").read_text())
        schema_validator("prediction.schema.json").validate(told)
        return told, done

    def test_prints_what_it_writes_and_needs_no_driver(self):
        told, done = self.predict("--preset", "lightcluster")
        self.assertEqual(done.stderr, "")
        rows = dict(line.split(maxsplit=1) for line in done.stdout.splitlines()[1:])
        for name in ("lights", "shadow_maps", "shadow_triangles", "shadow_draws"):
            self.assertEqual(rows[name], str(told["counters"][name]))
        self.assertGreater(told["counters"]["shadow_triangles"], 0)
        self.assertEqual(sorted(os.listdir(self.folder)), ["p.json"])

    def test_budgets_name_the_lights_that_lose_their_map(self):
        told, done = self.predict("--preset", "lightcluster", "--max-shadow-maps", 9)
        maps, shared = told["counters"]["shadow_maps"], told["lights_without_own_map"]
        self.assertLessEqual(maps, 9)
        self.assertEqual(len(shared), LIGHTS - maps)
        names = {f"Light {i}" for i in range(LIGHTS)}
        without = {each["light"] for each in shared}
        self.assertLessEqual(without, names)
        self.assertLessEqual({each["map_of"] for each in shared}, names - without)
        self.assertRegex(done.stderr, r"\Alightcluster: over budget [^\n]*Light \d+ \(Light \d+'s\), [^\n]* and \d+ more\n\Z")
        drawn = self.stats("--preset", "lightcluster", "--max-shadow-maps", 9)
        self.assertEqual(drawn["lights_without_own_map"], shared)
        self.assertEqual(drawn["recipe"], told["recipe"])

    def test_a_budget_for_every_light_is_silent(self):
        told, done = self.predict("--preset", "lightcluster", "--max-shadow-maps", LIGHTS)
        self.assertEqual(done.stderr, "")
        self.assertEqual(told["recipe"]["settings"]["d_init_m"], 0)
        self.assertEqual(told["lights_without_own_map"], [])

    def test_a_distance_is_the_least_of_a_budget(self):
        wide, _ = self.predict("--preset", "lightcluster", "--d-init", 1)
        maps = wide["counters"]["shadow_maps"]
        told, done = self.predict("--preset", "lightcluster", "--d-init", 1, "--max-shadow-maps", maps)
        self.assertEqual((told["recipe"], told["counters"], done.stderr), (wide["recipe"], wide["counters"], ""))
        told, done = self.predict("--preset", "lightcluster", "--d-init", 1, "--max-shadow-maps", maps - 1)
        self.assertLess(told["counters"]["shadow_maps"], maps)
        self.assertGreater(told["recipe"]["settings"]["d_init_m"], 1)
        self.assertRegex(done.stderr, r"\Alightcluster: over budget with d-init 1 m: d-init 1\.\d+ m makes \d+; without")

    def test_an_error_that_the_budget_misses_is_told(self):
        told, done = self.predict("--preset", "lightcluster", "--max-error", 0.05)
        self.assertLessEqual(told["expected_rmse_shown"], 0.05)
        self.assertGreater(told["recipe"]["settings"]["d_init_m"], 0)
        told, done = self.predict("--preset", "lightcluster", "--max-error", 0.001, "--max-shadow-maps", 4)
        self.assertLessEqual(told["counters"]["shadow_maps"], 4)
        missed = float(re.search(r"--max-error 0.001 is missed by ([0-9.]+)", done.stderr).group(1))
        self.assertAlmostEqual(told["expected_rmse_shown"], 0.001 + missed, delta=2e-4)
        drawn = self.stats("--preset", "lightcluster", "--max-error", 0.05)
        self.assertLessEqual(drawn["expected_rmse_shown"], 0.05)

    def test_selection_by_error_keeps_budgets_itself(self):
        told, done = self.predict("--preset", "chandelier", "--max-shadow-maps", 9)
        self.assertLessEqual(told["counters"]["shadow_maps"], 9)
        self.assertEqual(told["recipe"]["settings"]["max_maps"], 9)
        self.assertRegex(done.stderr, r"\Achandelier: over budget [^\n]* selection by error makes \d; [^\n]* and \d+ more\n\Z")
        drawn = self.stats("--preset", "chandelier", "--max-shadow-maps", 9)
        self.assertEqual((drawn["recipe"], drawn["lights_without_own_map"]), (told["recipe"], told["lights_without_own_map"]))
        without = {each["light"] for each in told["lights_without_own_map"]}
        self.assertEqual(len(without), told["counters"]["lights_in_view"] - told["counters"]["shadow_maps"])
        clusters, _ = self.predict("--preset", "lightcluster", "--max-shadow-maps", 9)
        self.assertLess(told["expected_rmse_shown"], 0.6 * clusters["expected_rmse_shown"])
        within, _ = self.predict("--preset", "chandelier", "--max-error", 0.05)
        self.assertLessEqual(within["expected_rmse_shown"], 0.05)
        self.assertLess(within["counters"]["shadow_maps"], 9)

    def test_a_limit_that_holds_a_map_for_each_light_is_not_called_short(self):
        _, done = self.predict("--preset", "chandelier", "--max-error", 0.05, "--max-shadow-maps", LIGHTS)
        self.assertRegex(done.stderr, r"\Achandelier: selection by error makes [^\n]*\n\Z")
        told, done = self.predict("--preset", "chandelier", "--max-error", 0)
        self.assertEqual((told["counters"]["shadow_maps"], told["expected_rmse_shown"]), (LIGHTS, 0))
        self.assertRegex(done.stderr, r"\Achandelier: selection by error makes [^\n]*\n\Z")
        self.assertNotIn("d_init_m", done.stdout)

    def test_bytes_are_a_budget_too(self):
        told, _ = self.predict("--preset", "lightcluster", "--max-shadow-bytes", 1)
        self.assertLessEqual(told["counters"]["shadow_bytes"], 1 << 20)
        self.assertGreater(told["counters"]["shadow_bytes"], 1 << 19)


if __name__ == "__main__":
    main()
