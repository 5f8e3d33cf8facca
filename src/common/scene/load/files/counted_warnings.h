// Warnings of a kind as one: files repeat their faults, sometimes a hundred thousand times.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pt {

class CountedWarnings {
 public:
  /// `message` names the place. Of each kind the first message is kept, how many followed, and of
  /// these the first few names of what they are about. Kinds are few: their texts are ours.
  void add(std::string_view kind, std::string_view message, std::string_view name = {});

  /// A line for each kind, in the order in which they came first.
  std::vector<std::string> lines() const;

 private:
  struct Kind {
    std::string message;
    std::size_t more = 0;
    std::vector<std::string> names;  ///< the first one is in the message
  };

  std::unordered_map<std::string, std::size_t> index_of_;
  std::vector<Kind> kinds_;
};

}  // namespace pt
