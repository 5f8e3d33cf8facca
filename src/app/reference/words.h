// What shells complete a value to, and how they are told of an option.
#pragma once

#include <string>
#include <vector>

#include "app/options/command_text.h"

namespace pt {

/// The option's choices; of a scene the built-in ones.
std::vector<std::string> words_of(const OptionText& option);

/// The first sentence of a help, cut where it is long.
std::string short_help(const std::string& help);

std::string join(const std::vector<std::string>& words, const std::string& separator);

/// Each `from` as `to`.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace pt
