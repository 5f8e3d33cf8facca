// The command line in other forms than --help: shell completions, the man page, a page of the site.
// All are made of CommandText.
#pragma once

#include <string>
#include <vector>

#include "app/options/command_line.h"

namespace pt {

std::string completion_text(const CompletionCommand& command);
std::string reference_text(const ReferenceCommand& command);

// Text for both.
std::string join(const std::vector<std::string>& words, const std::string& separator);
/// With `to` instead of each `from`.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace pt
