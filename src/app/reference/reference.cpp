#include "app/reference/reference.h"

namespace pt {

std::string completion_text(const CompletionCommand& command) {
  switch (command.shell) {
    case Shell::zsh:
      return zsh_completion(command.program);
    case Shell::fish:
      return fish_completion(command.program);
    case Shell::bash:
      break;
  }
  return bash_completion(command.program);
}

std::string reference_text(const ReferenceCommand& command) {
  const bool is_man = command.page == ReferencePage::man;
  return is_man ? man_page(command.program) : markdown_page(command.program);
}

}  // namespace pt
