# SPDX-License-Identifier: Apache-2.0
"""Kills chandelier-bake at a hundred moments: the pack is the old one or the new one, and nothing piles up."""
import fcntl
import random
import shutil
import signal
import subprocess
import time

from bake_tool import BAKE, BakeTool, main, move_lights

KILLS = 100


class Kill(BakeTool):
    def start(self):
        return subprocess.Popen([BAKE, self.scene, self.rig, "-o", self.pack, "--cache", self.cache, "--quiet"],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def kill_after_renaming(self, old):
        """What a kill as soon as the pack is another file leaves; None where the bake ended before."""
        self.pack.write_bytes(old)
        before = self.pack.stat().st_ino
        bake = self.start()
        while self.pack.stat().st_ino == before and bake.poll() is None:
            pass
        bake.send_signal(signal.SIGKILL)
        bake.communicate()
        return self.pack.read_bytes() if bake.returncode == -signal.SIGKILL else None

    def test_old_or_new(self):
        self.scene, self.rig = self.room()
        self.cache = self.folder / "cache"
        old, _ = self.bake(self.scene, self.rig)
        move_lights(self.rig)
        new, _ = self.bake(self.scene, self.rig, output=self.folder / "new.chandelier")
        self.assertNotEqual(old, new)
        began = time.monotonic()
        first = self.start()
        first.communicate()
        self.assertEqual(first.returncode, 0)
        duration = time.monotonic() - began

        rng = random.Random(3)
        killed, seen = 0, set()  # what kills left
        for i in range(KILLS):
            self.pack.write_bytes(old)
            if i % 2:
                shutil.rmtree(self.cache, ignore_errors=True)  # so that entries are being written too
            bake = self.start()
            time.sleep(duration * rng.uniform(0, 1.1))
            bake.send_signal(signal.SIGKILL)
            _, said = bake.communicate()
            killed += bake.returncode == -signal.SIGKILL
            self.assertIn(bake.returncode, (0, -signal.SIGKILL), said)
            now = self.pack.read_bytes()
            self.assertTrue(now in (old, new), f"neither old nor new after kill {i}")
            if bake.returncode == -signal.SIGKILL:
                seen.add(now)
            else:
                duration *= 0.9  # the machine has become faster since
        # Few of those, or none, fell between the pack's renaming and the end: so that moment is waited for.
        for _ in range(KILLS if new not in seen else 0):
            seen.add(self.kill_after_renaming(old))
            if new in seen:
                break
        self.assertEqual(seen - {None}, {old, new})
        self.assertGreater(killed, KILLS // 4, "hardly any was killed: the delays are too long")
        self.assert_opens(self.pack)

        # The next bake sweeps up, and the cache that was written by the killed is as good as none.
        done = self.run_bake(self.scene, self.rig, "-o", self.pack, "--cache", self.cache)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.pack.read_bytes(), new)
        for folder in (self.folder, self.cache):
            self.assertEqual([name for name in self.names(folder) if name.endswith(".tmp")], [])

    def test_a_living_writer_keeps_its_file(self):
        """The sweep takes what nobody holds, and leaves what somebody does."""
        held, left = self.folder / ".chandelier-1-0.tmp", self.folder / ".chandelier-2-0.tmp"
        other = self.folder / ".chandelier-notes.txt"
        for path in (left, other):
            path.write_text("x")
        with open(held, "w", encoding="utf-8") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.bake(self.room()[0])
            self.assertEqual((held.exists(), left.exists(), other.exists()), (True, False, True))


if __name__ == "__main__":
    main()
