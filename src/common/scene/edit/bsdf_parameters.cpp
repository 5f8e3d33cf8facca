#include "common/scene/edit/bsdf_parameters.h"

#include <string_view>
#include <utility>
#include <vector>

namespace pt {
namespace {

/// The name of an enumerator, as the compiler writes it: "... value = pt::Metal::Index::fuzz; ...".
template <auto value>
std::string enumerator_name() {
  std::string_view text = __PRETTY_FUNCTION__;
  text.remove_prefix(text.find("value = "));
  text = text.substr(0, text.find_first_of(";]"));
  return std::string(text.substr(text.rfind(':') + 1));
}

/// Notes which parameters a BSDF asks for as colours.
struct Asked {
  bool* is_color;

  Color color(int i) const {
    is_color[i] = true;
    return Color(0.5f);
  }
  float scalar(int) const { return 0.5f; }
};

/// None, of what only preparation makes of another material.
template <class Bsdf>
std::vector<BsdfParameter> parameters_of() {
  return {};
}

template <class Bsdf>
requires requires { Bsdf::Index::count; }
std::vector<BsdfParameter> parameters_of() {
  bool is_color[Bsdf::parameter_count + 1] = {};
  (void)Bsdf::make(Asked{is_color});
  using Index = decltype(Bsdf::Index::count);
  std::vector<BsdfParameter> list;
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (list.push_back({enumerator_name<static_cast<Index>(i)>(), is_color[i]}), ...);
  }
  (std::make_integer_sequence<int, Bsdf::parameter_count>());
  return list;
}

template <class... Bsdf>
std::vector<std::vector<BsdfParameter>> table_of(TypeList<Bsdf...>) {
  return {parameters_of<Bsdf>()...};
}

}  // namespace

std::span<const BsdfParameter> bsdf_parameters(MaterialKind kind) {
  static const auto table = table_of(Bsdfs{});
  return table[static_cast<std::size_t>(kind)];
}

}  // namespace pt
