// What `ptexp doctor` is asked for.
#pragma once

#include <vector>

#include "app/options/subcommand_option.h"

namespace pt {

struct DoctorCommand {
  bool as_json = false;
};

inline std::vector<SubcommandOption<DoctorCommand>> doctor_options() {
  return {{"json", nullptr, "Prints it as JSON",
           [](DoctorCommand& c, const std::string&) { c.as_json = true; }}};
}

}  // namespace pt
