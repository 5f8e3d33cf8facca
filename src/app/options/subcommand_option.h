// A subcommand's options as a table; subcommand.h gives it to CLI11.
#pragma once

#include <string>

namespace pt {

/// `set` parses and stores; it throws Error naming option and value.
template <class Command>
struct SubcommandOption {
  const char* name;
  const char* placeholder;  ///< of the value, with its default; null: a flag
  const char* help;
  void (*set)(Command&, const std::string& value);
  bool is_required = false;
};

}  // namespace pt
