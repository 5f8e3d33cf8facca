"""The simulation of many ranks: cases whose answer is known, and a second simulation without a queue
of events, which only asks what ends next.
"""
import math
import random
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "experiments"))
from lib.simulate_ranks import (  # noqa: E402
    PIECE_BYTES, Cluster, Job, Rule, broadcast_s, cluster_of, simulate)


def replay(job, cluster, rule, seed):
    """(end, work, units). Everything that goes on has a time left, and all of these shrink."""
    draw = random.Random(seed)
    count = len(cluster.speeds)
    windows = count * rule.units_per_device
    total = left = windows * rule.parts
    mean = sum(job.times) / len(job.times)
    cost, piece = None, 0
    link_in, link_out, desk = [], [], []  # queues: the first of each is being served
    under_way = []  # what the links have sent and the latency has not yet passed
    idle_until = {number: cluster.starts[number] for number in range(count)}  # before it asks
    running, waiting = {}, {number: [] for number in range(count)}
    has = [0] * count
    clock, end, work_done, units = 0.0, 0.0, 0.0, 0

    def to_rank_0(number, grains):
        size = job.film_bytes * job.passes * grains / total
        if number < cluster.local:
            to_desk(number, grains)
        else:
            link_in.append([size / cluster.bandwidth, number, grains])

    def to_desk(number, grains):
        copied = job.film_bytes * job.passes * grains / total
        desk.append([cluster.service_s + copied / cluster.copy_bandwidth, number, grains])

    def start(number):
        if number not in running and waiting[number]:
            grains, work = waiting[number].pop(0)
            running[number] = [job.overhead_s + work / cluster.speeds[number], grains]

    while True:
        going = [entry[0] for queue in (link_in, link_out, desk) for entry in queue[:1]]
        going += [entry[0] for entry in under_way] + [entry[0] for entry in running.values()]
        going += idle_until.values()
        if not going:
            return end, work_done, units
        step = min(going)
        clock += step
        for queue in (link_in, link_out, desk):
            for entry in queue[:1]:
                entry[0] -= step
        for entry in [*under_way, *running.values()]:
            entry[0] -= step
        for number in idle_until:
            idle_until[number] -= step
        done = 1e-12
        if link_in and link_in[0][0] <= done:
            _, number, grains = link_in.pop(0)
            under_way.append([cluster.latency_s, "in", number, grains, 0])
        elif link_out and link_out[0][0] <= done:
            _, number, grains, work = link_out.pop(0)
            under_way.append([cluster.latency_s, "out", number, grains, work])
        elif any(entry[0] <= done for entry in under_way):
            entry = next(entry for entry in under_way if entry[0] <= done)
            under_way.remove(entry)
            _, way, number, grains, work = entry
            if way == "in":
                to_desk(number, grains)
            else:
                waiting[number].append((grains, work))
                start(number)
        elif any(entry[0] <= done for entry in running.values()):
            number = next(number for number, entry in running.items() if entry[0] <= done)
            grains = running.pop(number)[1]
            to_rank_0(number, grains)
            start(number)
        elif any(wait <= done for wait in idle_until.values()):
            number = next(number for number, wait in idle_until.items() if wait <= done)
            del idle_until[number]
            to_rank_0(number, 0)
        elif desk and desk[0][0] <= done:
            _, number, grains = desk.pop(0)
            if grains:
                has[number] -= 1
                end = clock
            if left and has[number] < rule.capacity:
                if piece == 0:
                    piece, cost = rule.parts, draw.choice(job.times) / mean
                size = rule.parts if not rule.shrink else min(
                    rule.parts, left / (rule.shrink * count))
                size = max(int(size), 1)
                size = min(size, piece)
                piece -= size
                left -= size
                has[number] += 1
                units += 1
                work = job.work_s * size / total * cost
                work_done += work
                if number < cluster.local:
                    waiting[number].append((size, work))
                    start(number)
                else:
                    back = job.film_bytes * (job.passes - 1) * size / total
                    link_out.append([back / cluster.bandwidth, number, size, work])
                if has[number] < rule.capacity:
                    to_desk(number, 0)


class KnownAnswers(unittest.TestCase):
    def check(self, outcome, time_s, efficiency):
        self.assertAlmostEqual(outcome.time_s, time_s)
        self.assertAlmostEqual(outcome.efficiency, efficiency)
        self.assertAlmostEqual(sum(outcome.losses.values()) + outcome.efficiency, 1)
        self.assertGreaterEqual(min(outcome.losses.values()), -1e-9)

    def test_equal_units_and_nothing_else(self):
        for rule in (Rule(1), Rule(4), Rule(4, capacity=1), Rule(4, 1, 8), Rule(4, 2, 8, 1)):
            with self.subTest(rule=rule):
                if rule.shrink:  # units end unequally, by less than the largest
                    outcome = simulate(Job(70.0), Cluster((1.0,) * 7), rule)
                    self.assertTrue(10 <= outcome.time_s < 10 + 10 / 4 + 1e-9, outcome)
                else:
                    self.check(simulate(Job(70.0), Cluster((1.0,) * 7), rule), 10, 1)

    def test_one_straggler(self):
        # Eight units of 1 s: the fast device takes six while the slow one takes two of 3 s.
        slow = Cluster((1.0, 1 / 3))
        self.check(simulate(Job(8.0), slow, Rule(4, capacity=1)), 6, 1)
        # A unit each: the fast one waits for the slow one.
        self.check(simulate(Job(2.0), slow, Rule(1, capacity=1)), 3, 2 / 4)
        # The slow one took a second unit in advance and ends it at 6 s; four units in all.
        self.check(simulate(Job(4.0), slow, Rule(2, capacity=2)), 6, 4 / 8)
        self.check(simulate(Job(4.0), slow, Rule(2, capacity=1)), 3, 1)
        # Units that know how slow it is: it has 3 grains of 12 and the other one 9.
        self.check(simulate(Job(4.0), Cluster((1.0, 1 / 3)), Rule(2, 0, 3, 1, by_speed=True)), 3, 1)

    def test_one_unit_per_device(self):
        times = (1.0, 2.0, 5.0)
        cluster = Cluster((1.0,) * 30)
        outcome = simulate(Job(30.0, times), cluster, Rule(1), seed=4)
        mean = sum(times) / 3
        drawn = random.Random(4)
        costs = [drawn.choice(times) / mean for _ in range(30)]
        self.check(outcome, max(costs), sum(costs) / (30 * max(costs)))

    def test_windows_of_known_cost(self):
        # Two windows cost 1 and 3: as wholes 3 s; the dear one in parts of a third: 2 s.
        job = Job(4.0, (1.0, 3.0))
        seed = next(seed for seed in range(99) for draw in [random.Random(seed)]
                    if [draw.choice([1, 3]), draw.choice([1, 3])] == [1, 3])
        # Costs over their mean are 1/2 and 3/2, so parts are a half and more.
        whole = simulate(job, Cluster((1.0, 1.0)), Rule(1, 0, 6, 1), seed)
        self.check(whole, 3, 4 / 6)
        # The first window is a unit (6 grains, for its cost is below the mean), the other one has
        # units of 4 and 2 grains: 1 s, 2 s and 1 s.
        self.check(simulate(job, Cluster((1.0, 1.0)), Rule(1, 0, 6, 1, by_cost=True), seed), 2, 1)

    def test_rank_0_bound_by_bandwidth(self):
        job = Job(1e-6, film_bytes=5e6, passes=2)
        outcome = simulate(job, Cluster((1.0,) * 16, bandwidth=1e6), Rule(8))
        self.assertAlmostEqual(outcome.time_s, 10, delta=0.1)  # 5 s of it also in the other direction
        self.assertLess(outcome.efficiency, 1e-6)
        self.assertAlmostEqual(outcome.link, 1, delta=0.01)
        alone = simulate(job, Cluster((1.0,) * 16, local=16, bandwidth=1e6), Rule(8))
        self.check(alone, 1e-6 / 16, 1)
        copying = simulate(job, Cluster((1.0,) * 16, copy_bandwidth=1e6), Rule(8))
        self.assertAlmostEqual(copying.time_s, 10, delta=1e-3)

    def test_rank_0_bound_by_messages(self):
        # Each of 128 units is a result, and each device asks for its first and for a second one.
        outcome = simulate(Job(1e-6), Cluster((1.0,) * 16, service_s=0.01), Rule(8, capacity=1))
        self.assertAlmostEqual(outcome.time_s, 0.01 * (128 + 16), delta=1e-5)
        self.assertAlmostEqual(outcome.service, 1, delta=1e-5)

    def test_what_every_unit_costs(self):
        self.check(simulate(Job(40.0, overhead_s=0.5), Cluster((1.0,) * 4), Rule(5)), 12.5, 0.8)

    def test_late_devices(self):
        # 9 units of 1 s: the late one has time for 1 of them.
        late = Cluster((1.0, 1.0, 1.0), (0.0, 0.0, 3.0))
        outcome = simulate(Job(9.0), late, Rule(3, capacity=1))
        self.check(outcome, 4, 9 / 12)
        self.assertAlmostEqual(outcome.losses["start"], 3 / 12)
        # Too late for all.
        outcome = simulate(Job(2.0), Cluster((1.0, 1.0), (0.0, 9.0)), Rule(1, capacity=1))
        self.check(outcome, 2, 1 / 2)

    def test_what_rank_0_does_alone(self):
        outcome = simulate(Job(8.0, image_s=1.0), Cluster((1.0,) * 2), Rule(4))
        self.check(outcome, 5, 0.8)
        self.assertAlmostEqual(outcome.losses["image"], 0.2)

    def test_broadcasts(self):
        self.assertEqual(broadcast_s(1, 1e9, 1e9, 1, "binomial"), 0)
        self.assertAlmostEqual(broadcast_s(8, 1e9, 1e9, 0.5, "binomial"), 3 * 1.5)
        self.assertAlmostEqual(broadcast_s(9, 1e9, 1e9, 0.0, "binomial"), 4)
        # 7 ranks: depth 2; two messages for each piece, and one more piece for the second level.
        self.assertAlmostEqual(broadcast_s(7, 10 * PIECE_BYTES, PIECE_BYTES, 0.0, "binary"), 22)
        outcome = simulate(Job(8.0, scene_bytes=1e9),
                           Cluster((1.0,) * 4, bandwidth=1e9), Rule(4))
        self.check(outcome, 2 + 2, 0.5)
        self.assertAlmostEqual(outcome.losses["scene"], 0.5)

    def test_graham(self):
        # Graham 1966, 'Bounds for certain multiprocessing anomalies': whoever hands units to the
        # first that is free ends by work / m + (1 - 1 / m) times the longest unit.
        chance = random.Random(5)
        for seed in range(50):
            times = tuple(chance.lognormvariate(0, 1) for _ in range(20))
            count = chance.randrange(1, 30)
            outcome = simulate(Job(10.0, times), Cluster((1.0,) * count), Rule(3, capacity=1), seed)
            work = outcome.efficiency * outcome.time_s * count
            longest = 10 / (3 * count) * max(times) / (sum(times) / 20)
            self.assertLessEqual(outcome.time_s,
                                 work / count + (1 - 1 / count) * longest + 1e-9)
            self.assertGreaterEqual(outcome.time_s, work / count - 1e-9)


class Rules(unittest.TestCase):
    def test_sizes(self):
        rule = Rule(4, 2, 8)
        self.assertEqual([rule.grains(left, 2) for left in (64, 32, 31, 12, 4, 3, 1)],
                         [8, 8, 7, 3, 1, 1, 1])
        self.assertEqual(Rule(4, 0, 8).grains(1000, 2), 8)
        self.assertEqual(Rule(4, 0, 8, by_speed=True).grains(1000, 2, 0.5), 4)
        self.assertEqual([Rule(4, 0, 8, by_cost=True).grains(1000, 2, cost=cost)
                          for cost in (0.5, 1, 2, 100)], [8, 8, 4, 1])

    def test_clusters(self):
        cluster = cluster_of(4, 8, slow_share=0.25, slow_times=4, late_share=0.5, late_s=3, seed=1)
        self.assertEqual(sorted(cluster.speeds), [0.25] * 8 + [1.0] * 24)
        nodes = [set(cluster.starts[node * 8:node * 8 + 8]) for node in range(4)]
        self.assertEqual(set(map(len, nodes)), {1})
        self.assertEqual(sum(node == {0} for node in nodes), 2)
        self.assertEqual((cluster.local, cluster), (8, cluster_of(
            4, 8, slow_share=0.25, slow_times=4, late_share=0.5, late_s=3, seed=1)))


class Replay(unittest.TestCase):
    def test_small_cases(self):
        chance = random.Random(6)
        for seed in range(120):
            count = chance.randrange(1, 6)
            job = Job(count * 2.0, tuple(chance.uniform(0.2, 3) for _ in range(7)),
                      overhead_s=chance.choice([0, 0.05]), film_bytes=chance.choice([0, 100]),
                      passes=chance.randrange(1, 4))
            cluster = Cluster(
                tuple(chance.uniform(0.2, 1) for _ in range(count)),
                tuple(chance.uniform(0.001, 1) for _ in range(count)), chance.randrange(count + 1),
                chance.choice([50.0, 400.0]), chance.choice([0.0, 0.013]),
                chance.choice([0.001, 0.1, 0.6]), chance.choice([90.0, math.inf]))
            rule = Rule(chance.randrange(1, 6), chance.choice([0, 1, 2.5]), chance.randrange(1, 5),
                        chance.randrange(1, 4))
            with self.subTest(job=job, cluster=cluster, rule=rule):
                outcome = simulate(job, cluster, rule, seed)
                end, work, units = replay(job, cluster, rule, seed)
                self.assertAlmostEqual(outcome.time_s, end)
                self.assertAlmostEqual(outcome.efficiency, work / (end * sum(cluster.speeds)))
                self.assertEqual(outcome.units, units)
                self.assertAlmostEqual(sum(outcome.losses.values()) + outcome.efficiency, 1)


if __name__ == "__main__":
    unittest.main()
