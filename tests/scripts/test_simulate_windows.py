"""The program's rule for units in the simulation of many ranks: windows by hand, cases whose time is
known, and what the simulation is to find.
"""
import csv
import random
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
import scaling  # noqa: E402
from lib import harness  # noqa: E402
from lib import simulated_clusters as clusters  # noqa: E402
from lib.simulate_ranks import Cluster, Job  # noqa: E402
from lib.simulate_windows import CostMap, WindowRule, divide, simulate_windows  # noqa: E402

FLAT = [[1.0]]
WINDOWS_OF_A_HALF = {"first_share": 2, "unit_s": 5}
SMALLER_WINDOWS = {"first_share": 16, "unit_s": 1}


def pixels(rule, workers):
    return [window.pixels for window in divide(rule, workers, CostMap(FLAT, rule.width, rule.height))]


class Windows(unittest.TestCase):
    def test_by_hand(self):
        # Half a worker's share of 64 rows of 2 workers: 16 rows, then 8, 4, 2, and at least half one.
        self.assertEqual(pixels(WindowRule(100, 64, first_share=2), 2),
                         [100 * rows for rows in (16, 16, 8, 8, 4, 4, 2, 2, 1, 1)] + [50] * 4)
        # A quarter, by default: 8 rows, then 6, 5 and so on.
        self.assertEqual(pixels(WindowRule(100, 64), 2)[:6], [100 * rows for rows in (8, 8, 6, 6, 5, 5)])
        # Rows are whole: 1.5 become 2, and what is less than one a part of it.
        self.assertEqual(pixels(WindowRule(100, 6, first_share=2), 2), [200, 200, 50, 50, 25, 25, 12, 12, 6, 6, 4, 4,
                                                         4, 2])
        self.assertEqual(pixels(WindowRule(100, 6, first_share=2, round_up=False), 2)[:2], [100, 100])
        self.assertEqual(pixels(WindowRule(100, 64, first_share=8), 2)[:3], [400, 400, 400])

    def test_every_pixel_once(self):
        chance = random.Random(1)
        for _ in range(100):
            rule = WindowRule(chance.randrange(1, 90), chance.randrange(1, 90),
                              first_share=chance.choice([2, 8]), round_up=chance.choice([True, False]))
            self.assertEqual(sum(pixels(rule, chance.randrange(1, 20))), rule.width * rule.height)

    def test_costs(self):
        costs = CostMap([[1, 3], [4, 8]], 20, 10)  # mean 4
        self.assertEqual(costs.mean_of_rows(0, 5), 0.5)
        self.assertEqual(costs.mean_of_rows(0, 10), 1)
        self.assertAlmostEqual(costs.mean_of_rows(4, 2), 1)
        self.assertAlmostEqual(costs.mean_in_row(7, 5, 10), 1.5)
        self.assertAlmostEqual(costs.mean_in_row(0, 0, 10), 0.25)
        # However an image is cut, its cost is the same.
        rows = [[random.Random(i + 9 * j).random() for i in range(7)] for j in range(5)]
        for workers in (1, 3, 8):
            rule = WindowRule(70, 50)
            windows = divide(rule, workers, CostMap(rows, 70, 50))
            self.assertAlmostEqual(sum(w.pixels * w.cost for w in windows), 3500, delta=3500 * 1e-9)


class Times(unittest.TestCase):
    def test_one_device(self):
        outcome = simulate_windows(Job(12.0, overhead_s=0.5), Cluster((1.0,)), WindowRule(8, 8), FLAT)
        self.assertAlmostEqual(outcome.time_s, 12 + 0.5 * outcome.units)
        self.assertAlmostEqual(outcome.efficiency, 12 / outcome.time_s)

    def test_a_window_is_with_one_device(self):
        # The first row costs everything, and is a window for its cost is not known: one device has
        # all the work.
        rows = [[1.0], [0.0], [0.0], [0.0]]
        outcome = simulate_windows(Job(8.0), Cluster((1.0,) * 2), WindowRule(4, 4, first_share=2),
                                   rows)
        self.assertAlmostEqual(outcome.time_s, 8)
        self.assertAlmostEqual(outcome.efficiency, 0.5)

    def test_all_is_done_once(self):
        chance = random.Random(3)
        for _ in range(60):
            rows = [[chance.uniform(0.2, 2) for _ in range(9)] for _ in range(9)]
            count = chance.randrange(1, 9)
            cluster = Cluster(tuple(chance.uniform(0.3, 1) for _ in range(count)),
                              bandwidth=1e4, service_s=1e-3, latency_s=1e-3)
            rule = WindowRule(chance.randrange(5, 60), 40, unit_s=chance.choice([0.2, 5]),
                              even_s=chance.choice([0, 4]), capacity=chance.randrange(1, 3),
                              first_share=chance.choice([2, 8]))
            outcome = simulate_windows(Job(10.0, film_bytes=100), cluster, rule, rows)
            self.assertAlmostEqual(outcome.efficiency * outcome.time_s * sum(cluster.speeds), 10)
            self.assertAlmostEqual(sum(outcome.losses.values()) + outcome.efficiency, 1)
            # None is faster than all together, nor slower than the slowest alone.
            self.assertGreater(outcome.time_s, 10 / sum(cluster.speeds))


class Study(unittest.TestCase):
    def run_study(self, *arguments):
        with tempfile.TemporaryDirectory(prefix="ptexp scaling ") as folder:
            status = harness.main(scaling.EXPERIMENT, ["--simulate", "--output", folder, *arguments],
                                  scaling.run)
            self.assertEqual(status, 0)
            path, = Path(folder).glob("simulated/*.csv")
            with open(path, newline="", encoding="utf-8") as file:
                return list(csv.DictReader(file))

    def test_the_table(self):
        rows = self.run_study("--quick")
        self.assertEqual({row["x"] for row in rows}, {"8", "16"})
        for row in rows:
            low, middle, high = (float(row[f"efficiency_{end}"]) for end in ("low", "median", "high"))
            self.assertTrue(0 < low <= middle <= high <= 1, row)

    def test_predictions_for_one_machine(self):
        """Films that take longer than the image of two devices cost as much as they take."""
        arguments = harness.parse_arguments(scaling.EXPERIMENT, [
            "--unit-overhead", "0", "--latency", "0", "--service", "0", "--copy-bandwidth", "1e9",
            "--bandwidth", "0.0005", "--pixel-bytes", "100"])  # 0.5 MB/s
        arguments.cost_maps = []
        size = 100, 100  # 1 MB, half of it from the other rank
        self.assertGreater(clusters.predicted(1, 1.0, size, True, arguments), 0.999)
        local = clusters.predicted(2, 1.0, size, False, arguments)
        self.assertTrue(0.95 < local <= 1, local)
        over_links = clusters.predicted(2, 1.0, size, True, arguments)
        self.assertTrue(0.5 < over_links < 0.8 * local, over_links)
        # An image that takes longer hides them.
        self.assertGreater(clusters.predicted(2, 100.0, size, True, arguments), 0.95)

    def test_95_percent_of_1024_gpus(self):
        arguments = harness.parse_arguments(scaling.EXPERIMENT, [])
        maps = {"spheres": clusters.cost_maps(arguments)["spheres"]}
        for case in clusters.CASES[:2]:
            now, = clusters.simulated(case, WINDOWS_OF_A_HALF, 128, 10, maps, arguments)
            better, = clusters.simulated(case, SMALLER_WINDOWS, 128, 10, maps, arguments)
            self.assertLess(now.efficiency, 0.6)
            self.assertGreater(better.efficiency, 0.95)


if __name__ == "__main__":
    unittest.main()
