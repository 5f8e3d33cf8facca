#include "app/options/option_entry.h"

#include <utility>

namespace pt::option_entry {

OptionEntry integer(std::string name, int Options::*field, std::uint64_t lowest,
                    std::uint64_t highest) {
  OptionEntry entry{.name = name, .form = OptionForm::number, .placeholder = "N"};
  entry.set = [=](Options& options, const std::string& text) {
    options.*field = static_cast<int>(parse_integer(name, text, lowest, highest));
  };
  entry.text = [=](const Options& options) { return std::to_string(options.*field); };
  return entry;
}

OptionEntry text(std::string name, std::string placeholder, std::string Options::*field) {
  OptionEntry entry{.name = name, .placeholder = std::move(placeholder)};
  entry.set = [=](Options& options, const std::string& value) {
    // `--stats --quiet` forgot the file: it does not want one of the name --quiet.
    if (value.empty() || value.starts_with("--")) refuse_value(name, value, "expected a name");
    options.*field = value;
  };
  entry.text = [=](const Options& options) { return options.*field; };
  return entry;
}

OptionEntry vector(std::string name, std::optional<std::array<float, 3>> CameraOverrides::*field) {
  OptionEntry entry{.name = name, .form = OptionForm::vector, .placeholder = "X Y Z"};
  entry.set = [=](Options& options, const std::string& value) {
    options.camera.*field = parse_vector(name, value);
  };
  entry.text = [=](const Options& options) {
    const auto& value = options.camera.*field;
    return value ? vector_text(*value) : "";
  };
  return entry;
}

OptionEntry number(std::string name, std::string placeholder,
                   std::optional<float> CameraOverrides::*field, const char* expected,
                   bool (*holds)(float)) {
  OptionEntry entry{
      .name = name, .form = OptionForm::number, .placeholder = std::move(placeholder)};
  entry.set = [=](Options& options, const std::string& value) {
    options.camera.*field = parse_number(name, value, expected, holds);
  };
  entry.text = [=](const Options& options) {
    const auto& value = options.camera.*field;
    return value ? number_text(*value) : "";
  };
  return entry;
}

OptionEntry number(std::string name, std::string placeholder, float Options::*field,
                   const char* expected, bool (*holds)(float)) {
  OptionEntry entry{
      .name = name, .form = OptionForm::number, .placeholder = std::move(placeholder)};
  entry.set = [=](Options& options, const std::string& value) {
    options.*field = parse_number(name, value, expected, holds);
  };
  entry.text = [=](const Options& options) {
    return options.*field == 0.0f ? "" : number_text(options.*field);
  };
  return entry;
}

OptionEntry custom(std::string name, OptionForm form, std::string placeholder, Set set,
                   Text get_text) {
  OptionEntry entry{.name = std::move(name), .form = form, .placeholder = std::move(placeholder)};
  entry.set = std::move(set);
  entry.text = std::move(get_text);
  return entry;
}

}  // namespace pt::option_entry
