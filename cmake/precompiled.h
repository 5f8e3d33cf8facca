// What most files include, compiled once: about a third of a first build's time. No file may rely
// on it: each includes what it uses (PTEXP_PRECOMPILE=OFF shows it).
#pragma once

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
