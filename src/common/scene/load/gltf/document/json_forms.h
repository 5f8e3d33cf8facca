// Which kind of value each key of glTF's JSON has.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pt::gltf {

/// What a value of `key` should be, in words, if `value` is something else; else "". Keys that are
/// not known may be anything. Integers are from 0 to 2^31 - 1, as tinygltf stores them.
std::string expected_form(const std::string& key, const nlohmann::json& value);

/// Whether a value of the wrong form may be left out: it is a quantity or a flag, not part of the
/// file's structure.
bool may_be_lost(const std::string& key);

}  // namespace pt::gltf
