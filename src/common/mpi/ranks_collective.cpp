// The calls of Ranks that all ranks make together.
#include <fmt/format.h>

#include <algorithm>

#include "common/distribute/bytes.h"
#include "common/error/error.h"
#include "common/mpi/ranks.h"

namespace pt {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t piece_bytes = 8u << 20;  ///< of a broadcast: ranks pass on one by one

/// A binomial tree below rank 0: the rank that passes on to this one, and those after it.
int parent_of(int rank) { return rank & (rank - 1); }
std::vector<int> children_of(int rank, int count) {
  std::vector<int> children;
  for (int bit = 1; (rank & bit) == 0 && rank + bit < count; bit *= 2) {
    children.push_back(rank + bit);
  }
  std::ranges::reverse(children);  // the one with the most ranks below it first
  return children;
}

/// The first lines that differ.
std::pair<std::string, std::string> difference(std::string_view a, std::string_view b) {
  const auto line = [](std::string_view& text) {
    const std::string_view first = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(first.size() + 1, text.size()));
    return std::string(first);
  };
  while (!a.empty() || !b.empty()) {
    const std::string of_a = line(a), of_b = line(b);
    if (of_a != of_b) return {of_a, of_b};
  }
  return {};
}

/// What a rank has in place of rank 0's facts; empty: the same.
std::string objection(const std::vector<RankFact>& expected, ByteReader reader) {
  const auto facts = reader.list([&] {
    std::string name = reader.text();
    return RankFact{std::move(name), reader.text()};
  });
  for (std::size_t i = 0; i < std::max(expected.size(), facts.size()); ++i) {
    const RankFact wanted = i < expected.size() ? expected[i] : RankFact{};
    const RankFact found = i < facts.size() ? facts[i] : RankFact{};
    if (wanted == found) continue;
    if (wanted.first != found.first) {
      return fmt::format("expected to compare {}, has {}", wanted.first, found.first);
    }
    const auto [a, b] = difference(wanted.second, found.second);
    const auto shown = [](const std::string& text) { return text.empty() ? "none" : text; };
    return fmt::format("expected {} {}, has {}", wanted.first, shown(a), shown(b));
  }
  return {};
}

}  // namespace

void Ranks::announce(const std::vector<std::string>& devices) {
  const auto write_names = [](ByteWriter& writer, const std::vector<std::string>& names) {
    writer.list(names, [&](const std::string& name) { writer.text(name); });
  };
  ByteWriter own_devices;
  write_names(own_devices, devices);
  const std::vector<std::string> gathered = gather(own_devices.take());
  ByteWriter writer;
  writer.list(gathered, [&](const std::string& bytes) { writer.text(bytes); });
  std::string all = writer.take();
  broadcast(all);
  ByteReader reader(all);
  const auto lists = reader.list([&] { return reader.text(); });
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    ByteReader of_rank(lists.at(i));
    infos_[i].devices = of_rank.list([&] { return of_rank.text(); });
  }
}

void Ranks::agree(const std::vector<RankFact>& facts) {
  ByteWriter writer;
  writer.list(facts, [&](const RankFact& f) { writer.text(f.first), writer.text(f.second); });
  const std::vector<std::string> all = gather(writer.take());
  for (std::size_t i = 1; i < all.size(); ++i) {
    const std::string problem = objection(facts, ByteReader(all[i]));
    if (!problem.empty()) throw Error(fmt::format("{}: {}", infos_[i].name(), problem));
  }
  std::string verdict;  // until it comes the others wait, and the end comes instead
  broadcast(verdict);
}

void Ranks::broadcast(std::string& bytes) {
  if (count() == 1) return;
  const std::vector<int> children = children_of(rank(), count());
  const auto pass_on = [&](std::string&& piece) {
    const auto shared = std::make_shared<const std::string>(std::move(piece));
    for (const int child : children) channel_->send(child, MessageKind::collective, shared);
    if (!children.empty()) channel_->flush(4 * piece_bytes * children.size());
  };
  const auto next_piece = [&] { return expect(parent_of(rank()), MessageKind::collective).bytes; };
  ByteWriter writer;
  writer.number(std::uint64_t{bytes.size()});
  std::string header = is_first() ? writer.take() : next_piece();
  const auto size = ByteReader(header).number<std::uint64_t>();
  pass_on(std::move(header));
  if (!is_first()) bytes.clear(), bytes.reserve(size);
  for (std::uint64_t begin = 0; begin < size; begin += piece_bytes) {
    std::string piece = is_first() ? bytes.substr(begin, piece_bytes) : next_piece();
    if (!is_first()) bytes += piece;
    pass_on(std::move(piece));
  }
  gather({});  // rank 0 goes on, perhaps to the end, when all have it
}

std::vector<std::string> Ranks::gather(std::string bytes) {
  if (!is_first()) {
    send(0, MessageKind::collective, std::move(bytes));
    return {};
  }
  std::vector<std::string> all{std::move(bytes)};
  for (int from = 1; from < count(); ++from) {
    all.push_back(expect(from, MessageKind::collective).bytes);
  }
  return all;
}

}  // namespace pt
