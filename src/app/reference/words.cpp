#include "app/reference/words.h"

#include "common/scene/builtin/builtin_scenes.h"

namespace pt {

std::vector<std::string> words_of(const OptionText& option) {
  std::vector<std::string> words = option.choices();
  if (option.is_scene()) {
    for (const SceneInfo& scene : scene_list()) words.push_back(scene.name);
  }
  return words;
}

std::string short_help(const std::string& help) {
  constexpr std::size_t most = 76;
  std::string text = help.substr(0, help.find(". "));
  if (text.ends_with('.')) text.pop_back();
  if (text.size() <= most) return text;
  return text.substr(0, text.rfind(' ', most - 3)) + "...";
}

std::string join(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace pt
