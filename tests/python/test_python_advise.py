"""ptexp.advise: the advice can be followed, and what is wrong is said."""
import os
import signal
import threading
import time
import unittest

import numpy as np
import ptexp

SMALL = {"width": 16, "height": 8, "spp": 2, "max_depth": 3, "threads": 1, "device": "cpu"}


class Advise(unittest.TestCase):
    def setUp(self):
        self.scene = ptexp.load("spheres", spheres=20, **SMALL)

    def test_advice_can_be_followed(self):
        advice = ptexp.advise(self.scene, time_limit=60)
        self.assertEqual(advice.default.options, {})
        self.assertEqual(advice.default.word, "same")
        self.assertIn("megakernel", [way.mode for way in advice.ways])
        self.assertIn(advice.best, [advice.default, *advice.ways])
        self.assertEqual(advice.options, advice.best.options)
        for way in (advice.default, *advice.ways):
            middle, low, high = way.times_as_fast
            self.assertLessEqual(low, middle)
            self.assertLessEqual(middle, high)
            self.assertGreater(way.total_ms, 0)
            if way.word == "faster":
                self.assertGreater(low, 1)
            image = ptexp.render(self.scene, **way.options)
            np.testing.assert_array_equal(image.array, ptexp.render(self.scene).array)
            self.assertEqual(image.stats["execution"]["mode"] if "execution" in image.stats else way.mode, way.mode)
        self.assertGreaterEqual(advice.tried, 1 + len(advice.ways))
        self.assertEqual((advice.samples, advice.scale), (2, 1))
        self.assertEqual(sorted((way.times_as_fast[0] for way in advice.ways), reverse=True),
                         [way.times_as_fast[0] for way in advice.ways])
        lines = str(advice).splitlines()
        self.assertLessEqual(len(lines), 10)
        self.assertTrue(lines[0].startswith(advice.device))
        self.assertEqual(repr(advice), str(advice))

    def test_what_is_given_is_kept(self):
        advice = ptexp.advise(self.scene, mode="megakernel", accel="brute")
        self.assertEqual({way.mode for way in (advice.default, *advice.ways)}, {"megakernel"})
        for way in advice.ways:
            self.assertFalse({"mode", "accel"} & set(way.options))

    def test_a_name_is_loaded(self):
        self.assertGreater(ptexp.advise("furnace", **SMALL).rounds, 0)

    def test_errors(self):
        for options, words in (({"spp": 0}, "--spp 0"), ({"bogus": 1}, "bogus"), ({"output": "a.exr"}, "--output"),
                               ({"target_error": 0.1}, "--target-error"), ({"time_limit": 0}, "--time-limit 0"),
                               ({"time_limit": "1"}, "--time-limit 1"), ({"spheres": 3}, "spheres")):
            with self.assertRaises(ptexp.OptionError) as caught:
                ptexp.advise(self.scene, **options)
            self.assertIn(words, str(caught.exception))
        with self.assertRaisesRegex(ptexp.Error, "time_limit=1e-09"):
            ptexp.advise(self.scene, time_limit=1e-9)

    def test_ctrl_c(self):
        threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            ptexp.advise("cornell", width=2048, height=2048, spp=1000, device="cpu")
        self.assertLess(time.monotonic() - begin, 30)


if __name__ == "__main__":
    unittest.main()
