// `ptexp doctor`: what would run on this machine, what not, and what to do about it.
#pragma once

#include <string>
#include <vector>

#include "app/doctor/checks.h"
#include "app/options/doctor_options.h"

namespace pt {

/// Prints the checks of this machine. Returns 0, or 1 where anything is missing.
int doctor_command(const DoctorCommand& command);

/// A line for each check, and one for its remedy below.
std::string doctor_text(const std::vector<Check>& checks);
std::string doctor_json(const Machine& machine, const std::vector<Check>& checks);

}  // namespace pt
