// The command line in other forms than --help: shell completions, the man page, a page of the site.
// All are made of the same table (command_text.h).
#pragma once

#include <string>

#include "app/options/command_line.h"

namespace pt {

std::string completion_text(const CompletionCommand& command);
std::string reference_text(const ReferenceCommand& command);

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);
std::string man_page(const CommandText& program);
std::string markdown_page(const CommandText& program);

}  // namespace pt
