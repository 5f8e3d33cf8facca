// One body of tests for compaction, for every strategy and every device. A device under test is a
// class with
//
//   static bool available(); static constexpr const char* name;
//   void* allocate(std::size_t size_bytes); void release(void*);
//   void upload(void* to, const void* from, std::size_t size_bytes); void download(...);
//   Compactor compactor(TagPass, std::uint32_t slot_count_max);
//   static std::vector<Shape> shapes();   // ways to run a stage, the usual one first
//   static constexpr int pass_queues_max;  // queues that a gathering pass fills at once
//   void run(const Stage&, const StageQueues&, const Shape&);
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/error/error.h"
#include "common/options/compaction_info.h"
#include "statistics.h"
#include "wavefront/wave_buffers.h"

namespace pt {

using Compactor = std::function<void(const CompactionRequest&)>;
using Slots = std::vector<std::uint32_t>;

/// A slot's part in a case: it waits for the first or the second stage asked about, or for others.
enum class Role : std::uint8_t { first, second, other, another };

struct RolePattern {
  const char* name;
  Role (*role)(std::uint32_t slot, std::uint32_t slot_count);
};

/// The finalizer of MurmurHash3: as good as random here.
inline std::uint32_t scrambled(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x85ebca6bu;
  x = (x ^ x >> 13) * 0xc2b2ae35u;
  return x ^ x >> 16;
}

/// Waits for the first or second stage with this probability.
inline Role random_role(std::uint32_t slot, double density) {
  const std::uint32_t bits = scrambled(slot);
  const bool waits = bits >> 1 < density * 0x80000000u;
  return static_cast<Role>((waits ? 0 : 2) + bits % 2);
}

inline const RolePattern role_patterns[] = {
    {"none", [](auto, auto) { return Role::other; }},
    {"all first", [](auto, auto) { return Role::first; }},
    {"all second", [](auto, auto) { return Role::second; }},
    {"lowest", [](auto i, auto) { return i == 0 ? Role::first : Role::other; }},
    {"highest", [](auto i, auto n) { return i == n - 1 ? Role::second : Role::another; }},
    {"both ends",
     [](auto i, auto n) { return i == n - 1 ? Role::first
                                 : i == 0   ? Role::second
                                            : Role::other; }},
    {"in turn", [](auto i, auto) { return i % 2 ? Role::first : Role::second; }},
    {"every other", [](auto i, auto) { return i % 2 ? Role::another : Role::first; }},
    {"1 %", [](auto i, auto) { return random_role(i, 0.01); }},
    {"half", [](auto i, auto) { return random_role(i, 0.5); }},
    {"99 %", [](auto i, auto) { return random_role(i, 0.99); }},
};
inline constexpr std::size_t pattern_half = 9;  ///< a pattern with many of all roles

inline const std::uint32_t every_pattern_sizes[] = {
    0, 1, 2, 31, 32, 33, 255, 256, 257, 511, 512, 513, 1000, 1023, 1024, 1025, 8191, 8192, 8193};
inline const std::uint32_t some_pattern_sizes[] = {65535,          65536,    65537,
                                                   (1u << 20) - 1, 1u << 20, (1u << 20) + 1};
/// With random tags only.
inline const std::uint32_t large_sizes[] = {(1u << 24) - 1, 1u << 24, (1u << 24) + 1};

inline std::vector<Role> make_roles(const RolePattern& pattern, std::uint32_t slot_count) {
  std::vector<Role> roles(slot_count);
  for (std::uint32_t i = 0; i < slot_count; ++i) roles[i] = pattern.role(i, slot_count);
  return roles;
}

/// Calls test(roles) for all sizes and patterns.
template <class Test>
void for_each_case(Test&& test) {
  const auto run = [&](const RolePattern& pattern, std::uint32_t n) {
    if (testing::Test::HasFailure()) return;
    SCOPED_TRACE(testing::Message() << n << " slots, waiting: " << pattern.name);
    test(make_roles(pattern, n));
  };
  for (const std::uint32_t n : every_pattern_sizes) {
    for (const RolePattern& pattern : role_patterns) run(pattern, n);
  }
  for (const std::uint32_t n : some_pattern_sizes) {
    for (const std::size_t i : {std::size_t{2}, std::size_t{5}, pattern_half, pattern_half + 1}) {
      run(role_patterns[i], n);
    }
  }
  for (const std::uint32_t n : large_sizes) run(role_patterns[pattern_half], n);
}

/// Tells the first difference only: the arrays are long.
template <class T>
void expect_equal_arrays(const std::vector<T>& found, const std::vector<T>& expected,
                         const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  if (found == expected) return;
  const auto [f, e] = std::mismatch(found.begin(), found.end(), expected.begin());
  ADD_FAILURE() << what << ": [" << f - found.begin() << "] is " << static_cast<std::uint32_t>(*f)
                << ", expected " << static_cast<std::uint32_t>(*e);
}

/// An array in the device's memory between two strips that nobody may write to.
template <class Device, class T>
class GuardedArray {
 public:
  GuardedArray(Device& device, const std::vector<T>& values)
      : device_(device),
        size_bytes_(values.size() * sizeof(T)),
        memory_(static_cast<std::uint8_t*>(device.allocate(size_bytes_ + 2 * strip_bytes))) {
    const std::vector<std::uint8_t> strip(strip_bytes, strip_byte);
    device_.upload(memory_, strip.data(), strip_bytes);
    device_.upload(memory_ + strip_bytes, values.data(), size_bytes_);
    device_.upload(memory_ + strip_bytes + size_bytes_, strip.data(), strip_bytes);
  }
  GuardedArray(const GuardedArray&) = delete;
  GuardedArray& operator=(const GuardedArray&) = delete;
  ~GuardedArray() { device_.release(memory_); }

  T* data() { return reinterpret_cast<T*>(memory_ + strip_bytes); }

  void upload(const std::vector<T>& values) {
    ASSERT_EQ(values.size() * sizeof(T), size_bytes_);
    device_.upload(data(), values.data(), size_bytes_);
  }

  void expect(const std::vector<T>& expected, const std::string& what) {
    expect_equal_arrays(download(what), expected, what);
  }

  std::vector<T> download(const std::string& what) {
    std::vector<std::uint8_t> strips(2 * strip_bytes);
    device_.download(strips.data(), memory_, strip_bytes);
    device_.download(&strips[strip_bytes], memory_ + strip_bytes + size_bytes_, strip_bytes);
    EXPECT_EQ(strips, std::vector<std::uint8_t>(strips.size(), strip_byte))
        << what << ": written out of bounds";
    std::vector<T> values(size_bytes_ / sizeof(T));
    device_.download(values.data(), data(), size_bytes_);
    return values;
  }

 private:
  static constexpr std::size_t strip_bytes = 1024;
  static constexpr std::uint8_t strip_byte = 0xa5;

  Device& device_;
  std::size_t size_bytes_;
  std::uint8_t* memory_;
};

inline constexpr std::uint32_t poison = 0xdeadbeef;  ///< what no slot and no count is

inline Slots waiting_slots(const std::vector<Role>& roles, Role role) {
  Slots slots;
  for (std::uint32_t i = 0; i < roles.size(); ++i) {
    if (roles[i] == role) slots.push_back(i);
  }
  return slots;
}

/// The arrays of a request, used for several passes one after the other.
template <class Device>
class PassTest {
 public:
  PassTest(Device& device, TagPass pass, std::uint32_t slot_count, std::uint32_t slot_count_max)
      : pass_(pass),
        compact_(device.compactor(pass, slot_count_max)),
        tags_(device, std::vector<StageId>(slot_count)),
        queues_{{device, Slots(slot_count, poison)}, {device, Slots(slot_count, poison)}},
        counts_(device, Slots(2, poison)),
        contents_{Slots(slot_count, poison), Slots(slot_count, poison)} {
    request_.tags = tags_.data();
    request_.slot_count = request_.capacity = slot_count;
    request_.queues_wanted = 2;
    for (int c = 0; c < 2; ++c) request_.queues[c] = queues_[c].data();
    request_.counts = counts_.data();
  }

  CompactionRequest& request() { return request_; }

  /// One pass; `meaning` is the tag of each role.
  void expect_pass(const std::vector<Role>& roles, const StageId (&meaning)[4]) {
    std::vector<StageId> tags;
    tags.reserve(roles.size());
    for (const Role role : roles) tags.push_back(meaning[static_cast<int>(role)]);
    tags_.upload(tags);
    request_.wanted[0] = meaning[0], request_.wanted[1] = meaning[1];
    compact_(request_);
    Slots counts;
    for (int c = 0; c < 2; ++c) {
      const Slots waiting = waiting_slots(roles, static_cast<Role>(c));
      counts.push_back(static_cast<std::uint32_t>(waiting.size()));
      if (pass_ != TagPass::count) std::ranges::copy(waiting, contents_[c].begin());
    }
    counts_.expect(counts, "counts");
    expect_contents();
    tags_.expect(tags, "tags");
  }

  /// Calls change(request) on a request that would be served and expects it to be refused.
  void expect_refusal(const std::function<void(CompactionRequest&)>& change,
                      const std::string& message) {
    const CompactionRequest before = request_;
    change(request_);
    try {
      compact_(request_);
      ADD_FAILURE() << "not refused; expected: " << message;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
    request_ = before;
    expect_contents();
  }

 private:
  void expect_contents() {
    for (int c = 0; c < 2; ++c) queues_[c].expect(contents_[c], "queue " + std::to_string(c));
  }

  TagPass pass_;
  Compactor compact_;
  GuardedArray<Device, StageId> tags_;
  GuardedArray<Device, std::uint32_t> queues_[2], counts_;
  Slots contents_[2];  ///< of the queues, with what earlier passes left behind
  CompactionRequest request_;
};

/// Where a slot went in a case, by role; both others stay where they are.
inline constexpr StageId tag_meanings[][4] = {
    {StageId::shade_miss, StageId::shade_surface, free_slot, StageId::intersect},
    {free_slot, StageId::intersect, StageId::shade_surface, StageId::shade_miss},
    {StageId::shade_surface, StageId::shade_miss, free_slot, free_slot},
};

/// A stage without physics: every slot goes where the case wants it.
template <StageId first, StageId second, bool shadows>
struct SortingStage {
  static constexpr StageId id = StageId::intersect;
  static constexpr StageOutcomes outcomes = {{first, second}, true, shadows};
  const Next* next;      ///< [slot]
  std::uint32_t* calls;  ///< [slot]: how often the stage was called for it
  std::uint32_t* ranks;  ///< [slot]: the place in the queue that it was told

  PT_HD Next operator()(const Scene&, std::uint32_t slot, std::uint32_t rank) const {
    ++calls[slot];
    ranks[slot] = rank;
    return next[slot];
  }
};

/// Runs a stage on slots of the roles first and second (with StageInput::every_slot: on all, the
/// others going the same two ways), and the pass behind it if the strategy makes one.
template <class Stage, class Device>
class SendTest {
 public:
  SendTest(Device& device, const CompactionInfo& strategy, StageInput input,
           std::vector<Role> roles)
      : device_(device), strategy_(strategy), input_(input), roles_(std::move(roles)) {
    for (Role& role : roles_) {
      if (input == StageInput::every_slot) role = static_cast<Role>(static_cast<int>(role) % 2);
    }
  }

  /// `dropped`: nobody waits for these.
  void expect_sent(typename Device::Shape shape, const std::vector<StageId>& dropped = {}) {
    const auto n = static_cast<std::uint32_t>(roles_.size());
    TestRandom random(n);
    std::vector<Next> next(n);
    std::vector<StageId> tags(n), shadow_tags(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      const int role = static_cast<int>(roles_[i]);
      next[i] = {Stage::outcomes.to[role % 2], shadows && random.bits() % 3 == 0};
      tags[i] = role < 2 ? stage_info(Stage::id).queue : free_slot;
      shadow_tags[i] = static_cast<StageId>(random.below(4));
    }
    const Slots slots = input_slots(random);

    GuardedArray<Device, Next> device_next(device_, next);
    GuardedArray<Device, std::uint32_t> calls(device_, Slots(n)), ranks(device_, Slots(n, poison));
    GuardedArray<Device, StageId> device_tags(device_, tags), device_shadow(device_, shadow_tags);
    GuardedArray<Device, std::uint32_t> input(device_, slots);
    const std::uint32_t length =
        input_ == StageInput::tags ? n : static_cast<std::uint32_t>(slots.size());
    GuardedArray<Device, std::uint32_t> count(device_, {length});

    StageQueues q;
    q.input = input_;
    q.slots = input_ == StageInput::queue ? input.data() : nullptr;
    q.count = count.data();
    const bool appends = q.appends = strategy_.appends;
    q.tags = appends ? nullptr : device_tags.data();
    q.shadow_tags = appends || !shadows ? nullptr : device_shadow.data();
    // Every queue holds something already; what comes is appended behind it.
    Slots ends, contents(rests_size + n, poison);
    for (std::uint32_t i = 0; i <= queue_count; ++i) ends.push_back(5 * i);
    std::vector<std::unique_ptr<GuardedArray<Device, std::uint32_t>>> queues;
    for (int i = 0; i < queue_count; ++i) {
      queues.push_back(std::make_unique<GuardedArray<Device, std::uint32_t>>(device_, contents));
      const bool used = std::ranges::find(dropped, i, queue_index) == dropped.end();
      q.next[i] = used && strategy_.has_queues ? queues.back()->data() : nullptr;
    }
    GuardedArray<Device, std::uint32_t> waiting(device_, ends);
    q.waiting = waiting.data();

    device_.run(Stage{device_next.data(), calls.data(), ranks.data()}, q, shape);

    expect_calls(slots, calls.download("calls"), ranks.download("ranks"));
    std::vector<Slots> sent(queue_count);
    for (const std::uint32_t slot : slots) {
      tags[slot] = next[slot].to;
      if (shadows) shadow_tags[slot] = next[slot].shadow ? StageId::shadow : free_slot;
      const int to = queue_index(next[slot].to);
      if (appends && q.next[to] != nullptr) sent[to].push_back(slot);
      if (appends && next[slot].shadow) sent[queue_index(StageId::shadow)].push_back(slot);
    }
    if (!appends) {
      device_tags.expect(tags, "tags");
      if (shadows) device_shadow.expect(shadow_tags, "shadow tags");
    }
    for (std::size_t i = 0; i < queue_count; ++i) {
      expect_appended(sent[i], ends[i], queues[i]->download("queue"), i);
      ends[i] += static_cast<std::uint32_t>(sent[i].size());
    }
    waiting.expect(ends, "ends of the queues");
  }

 private:
  static constexpr bool shadows = Stage::outcomes.casts_shadow_rays;
  static constexpr std::uint32_t rests_size = 5 * queue_count;

  /// In an order that the stage must not rely on.
  Slots input_slots(TestRandom& random) {
    Slots slots;
    for (std::uint32_t i = 0; i < roles_.size(); ++i) {
      if (static_cast<int>(roles_[i]) < 2) slots.push_back(i);
    }
    if (input_ == StageInput::tags || input_ == StageInput::every_slot) return slots;
    for (std::size_t i = slots.size(); i > 1; --i) {
      std::swap(slots[i - 1], slots[random.below(static_cast<std::uint32_t>(i))]);
    }
    return slots;
  }

  void expect_calls(const Slots& slots, const Slots& calls, const Slots& ranks) {
    Slots expected_calls(roles_.size()), expected_ranks(roles_.size(), poison);
    for (std::uint32_t k = 0; k < slots.size(); ++k) {
      expected_calls[slots[k]] = 1;
      expected_ranks[slots[k]] = input_ == StageInput::tags ? slots[k] : k;
    }
    expect_equal_arrays(calls, expected_calls, "calls of the stage");
    expect_equal_arrays(ranks, expected_ranks, "places in the queue");
  }

  /// Nothing before `end`, a permutation of `slots` from there on, nothing behind.
  static void expect_appended(Slots slots, std::uint32_t end, Slots queue, std::size_t id) {
    const auto begin = queue.begin() + end;
    const auto count = static_cast<std::ptrdiff_t>(slots.size());
    std::sort(slots.begin(), slots.end());
    std::sort(begin, begin + count);
    Slots expected(queue.size(), poison);
    std::ranges::copy(slots, expected.begin() + end);
    expect_equal_arrays(queue, expected, "queue " + std::to_string(id) + ", sorted");
  }

  Device& device_;
  const CompactionInfo strategy_;
  StageInput input_;
  std::vector<Role> roles_;
};

template <class Device>
class CompactionOf : public testing::Test {
 protected:
  void SetUp() override {
    if (!Device::available()) GTEST_SKIP() << "no " << Device::name << " device";
  }
};
TYPED_TEST_SUITE_P(CompactionOf);

/// Every strategy that makes a pass.
inline const std::vector<CompactionInfo> pass_strategies = [] {
  std::vector<CompactionInfo> result;
  std::ranges::copy_if(compaction_table, std::back_inserter(result),
                       [](const CompactionInfo& s) { return s.pass != TagPass::none; });
  return result;
}();

TYPED_TEST_P(CompactionOf, APassFindsExactlyTheWaitingSlots) {
  TypeParam device;
  for (const CompactionInfo& strategy : pass_strategies) {
    SCOPED_TRACE(strategy.name);
    for_each_case([&](std::vector<Role> roles) {
      const auto n = static_cast<std::uint32_t>(roles.size());
      const bool large = n > some_pattern_sizes[5];
      if (large && !strategy.has_queues) return;
      PassTest<TypeParam> test(device, strategy.pass, n, n + n / 3);
      test.expect_pass(roles, tag_meanings[0]);
      if (large) return;
      // The same buffers again, with other queues and other slots in them.
      std::rotate(roles.begin(), roles.begin() + n / 3, roles.end());
      test.expect_pass(roles, tag_meanings[1]);
      test.expect_pass(roles, tag_meanings[2]);
      test.expect_pass(std::vector<Role>(n, Role::another), tag_meanings[0]);
    });
  }
}

// The number of queues is the request's: one for each kind of slot, or one alone.
TYPED_TEST_P(CompactionOf, APassFillsAnyNumberOfQueues) {
  TypeParam device;
  constexpr std::uint32_t n = 20000;
  std::vector<StageId> tags;
  for (std::uint32_t i = 0; i < n; ++i) {
    tags.push_back(stage_table[scrambled(i) % CompactionRequest::queues_max].id);
  }
  for (const CompactionInfo& strategy : pass_strategies) {
    SCOPED_TRACE(strategy.name);
    const bool gathers = strategy.has_queues;
    const int most = gathers ? TypeParam::pass_queues_max : CompactionRequest::queues_max;
    for (int wanted = 1; wanted <= most; ++wanted) {
      SCOPED_TRACE(testing::Message() << wanted << " queues");
      GuardedArray<TypeParam, StageId> device_tags(device, tags);
      GuardedArray<TypeParam, std::uint32_t> counts(
          device, Slots(static_cast<std::size_t>(std::max(wanted, 2)), poison));
      std::vector<std::unique_ptr<GuardedArray<TypeParam, std::uint32_t>>> queues;
      CompactionRequest request;
      request.tags = device_tags.data();
      request.slot_count = request.capacity = n;
      request.counts = counts.data();
      for (request.queues_wanted = 0; request.queues_wanted < wanted; ++request.queues_wanted) {
        queues.push_back(
            std::make_unique<GuardedArray<TypeParam, std::uint32_t>>(device, Slots(n, poison)));
        request.wanted[request.queues_wanted] = stage_table[request.queues_wanted].id;
        request.queues[request.queues_wanted] = queues.back()->data();
      }
      device.compactor(strategy.pass, n)(request);
      const Slots found = counts.download("counts");
      for (std::size_t c = 0; c < queues.size(); ++c) {
        Slots slots;
        for (std::uint32_t i = 0; i < n; ++i) {
          if (tags[i] == stage_table[c].id) slots.push_back(i);
        }
        EXPECT_EQ(found[c], slots.size());
        slots.resize(gathers ? slots.size() : 0);
        slots.resize(n, poison);
        queues[c]->expect(slots, "queue " + std::to_string(c));
      }
    }
  }
}

TYPED_TEST_P(CompactionOf, CountsWithoutQueues) {
  TypeParam device;
  for (const std::uint32_t n : {1u, 1000u, 65537u}) {
    PassTest<TypeParam> test(device, TagPass::count, n, n);
    test.request().queues[0] = test.request().queues[1] = nullptr;
    test.expect_pass(make_roles(role_patterns[pattern_half], n), tag_meanings[0]);
  }
}

TYPED_TEST_P(CompactionOf, RefusesWhatCouldOverflow) {
  TypeParam device;
  for (const CompactionInfo& strategy : pass_strategies) {
    SCOPED_TRACE(strategy.name);
    PassTest<TypeParam> test(device, strategy.pass, 1000, 1000);
    const std::vector<Role> roles = make_roles(role_patterns[pattern_half], 1000);
    test.expect_pass(roles, tag_meanings[0]);
    test.expect_refusal([](CompactionRequest& r) { r.capacity = 999; }, "999 places for 1000");
    test.expect_refusal([](CompactionRequest& r) { r.capacity = 0; }, "0 places for 1000");
    test.expect_refusal([](CompactionRequest& r) { r.wanted[1] = r.wanted[0]; }, "are the same");
    test.expect_refusal([](CompactionRequest& r) { r.queues_wanted = 0; }, "0 queues wanted");
    test.expect_refusal(
        [](CompactionRequest& r) { r.queues_wanted = CompactionRequest::queues_max + 1; },
        "queues wanted; expected 1 to");
    test.expect_refusal([](CompactionRequest& r) { r.slot_count = r.capacity = 0x80000000u; },
                        "2147483648 slots");
    test.expect_pass(roles, tag_meanings[1]);
  }
}

/// Calls test(strategy, input) for all that a stage can be run with.
template <class Device, class Test>
void for_each_input(Test&& test) {
  const auto run = [&](const CompactionInfo& strategy, StageInput input, const char* name) {
    if (testing::Test::HasFailure()) return;
    SCOPED_TRACE(testing::Message() << strategy.name << ", " << name);
    test(strategy, input);
  };
  for (const CompactionInfo& strategy : compaction_table) {
    if (!strategy.has_queues) run(strategy, StageInput::tags, "by tag");
    if (strategy.has_queues) run(strategy, StageInput::queue, "a queue");
    if (strategy.appends) run(strategy, StageInput::every_slot, "every slot");
  }
}

/// Runs all kinds of stages once.
template <class Device>
void expect_all_sent(Device& device, const std::vector<Role>& roles,
                     const typename Device::Shape& shape) {
  using enum StageId;
  for_each_input<Device>([&](const CompactionInfo& strategy, StageInput input) {
    SendTest<SortingStage<shade_surface, shade_miss, false>, Device>(device, strategy, input, roles)
        .expect_sent(shape);
    SendTest<SortingStage<intersect, generate, true>, Device> shadows(device, strategy, input,
                                                                      roles);
    shadows.expect_sent(shape);
    shadows.expect_sent(shape, {generate});
    SendTest<SortingStage<generate, generate, false>, Device> ends(device, strategy, input, roles);
    ends.expect_sent(shape);
    ends.expect_sent(shape, {generate});
  });
}

TYPED_TEST_P(CompactionOf, AStageSendsEverySlotOn) {
  TypeParam device;
  for_each_case([&](const std::vector<Role>& roles) {
    if (roles.size() > some_pattern_sizes[2]) return;
    expect_all_sent(device, roles, TypeParam::shapes().front());
  });
}

TYPED_TEST_P(CompactionOf, AStageSendsEverySlotOnInEveryShape) {
  TypeParam device;
  for (const auto& shape : TypeParam::shapes()) {
    SCOPED_TRACE(shape.text());
    for (const std::uint32_t n : {1u, 33u, 5000u}) {
      SCOPED_TRACE(testing::Message() << n << " slots");
      expect_all_sent(device, make_roles(role_patterns[pattern_half], n), shape);
    }
  }
}

TYPED_TEST_P(CompactionOf, AStageSendsMillionsOfSlotsOn) {
  TypeParam device;
  for (const std::uint32_t n : {(1u << 20) - 1, 1u << 20, (1u << 22) + 1}) {
    SendTest<SortingStage<StageId::shade_surface, StageId::shade_miss, false>, TypeParam>(
        device, compaction_info(Compaction::atomic), StageInput::queue,
        make_roles(role_patterns[pattern_half], n))
        .expect_sent(TypeParam::shapes().front());
  }
}

REGISTER_TYPED_TEST_SUITE_P(CompactionOf, APassFindsExactlyTheWaitingSlots,
                            APassFillsAnyNumberOfQueues, CountsWithoutQueues,
                            RefusesWhatCouldOverflow, AStageSendsEverySlotOn,
                            AStageSendsEverySlotOnInEveryShape, AStageSendsMillionsOfSlotsOn);

}  // namespace pt
