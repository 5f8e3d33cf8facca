// Animations, evaluated at one time: they say where nodes are and how far targets have morphed
// (specification, sections 3.11 and, for the interpolation, appendix C).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/nodes.h"
#include "common/scene/load/gltf/read_model.h"

namespace pt::gltf {
namespace {

using Numbers = std::vector<double>;

/// What a channel may change, as `components` numbers in each element of an accessor.
struct Property {
  std::string_view name;
  Numbers tinygltf::Node::*values;
  int components;
};
constexpr Property properties[] = {{"translation", &tinygltf::Node::translation, 3},
                                   {"rotation", &tinygltf::Node::rotation, 4},
                                   {"scale", &tinygltf::Node::scale, 3},
                                   {"weights", &tinygltf::Node::weights, 1}};

/// Numbers that all channels may read: as many as the largest file has. Several channels may name
/// one accessor, so that a small file asks for much time.
constexpr std::size_t max_numbers = std::size_t{1} << 30;

/// A time among the keys of a sampler: at `key`, or after it by a fraction of the seconds to the
/// next one.
struct KeyTime {
  std::size_t keys = 0;
  std::size_t key = 0;
  double seconds = 0, fraction = 0;  ///< 0: before the first key, or after the last
};

/// The keys do not descend.
KeyTime find_key(const std::vector<float>& keys, float time) {
  const auto next = std::ranges::upper_bound(keys, time);
  KeyTime found{keys.size()};
  if (next == keys.begin()) return found;
  found.key = static_cast<std::size_t>(next - keys.begin()) - 1;
  if (next == keys.end()) return found;
  const double begin = keys[found.key];
  found.seconds = *next - begin;
  found.fraction = (time - begin) / found.seconds;
  return found;
}

double dot(const Numbers& a, const Numbers& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

Numbers weighted_sum(double s, const Numbers& a, double t, const Numbers& b) {
  Numbers sum(a.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = s * a[i] + t * b[i];
  return sum;
}

Numbers unit(const Numbers& a) { return weighted_sum(1 / std::sqrt(dot(a, a)), a, 0.0, a); }

/// Along the shorter of the two arcs between unit quaternions (Shoemake 1985).
Numbers slerp(const Numbers& a, const Numbers& b, double t) {
  const double cosine = dot(a, b), sign = cosine < 0 ? -1 : 1;
  const double angle = std::acos(std::min(std::abs(cosine), 1.0)), sine = std::sin(angle);
  if (sine < 1e-6) return weighted_sum(1 - t, a, sign * t, b);
  return weighted_sum(std::sin((1 - t) * angle) / sine, a, sign * std::sin(t * angle) / sine, b);
}

/// `values`: `width` numbers for each key; of a cubic spline an in-tangent, a value and an
/// out-tangent, each of `width` numbers.
Numbers interpolate(const KeyTime& at, const std::string& interpolation,
                    const std::vector<float>& values, std::size_t width, bool rotates) {
  const bool is_cubic = interpolation == "CUBICSPLINE";
  const auto part = [&](std::size_t key, std::size_t index) {
    const float* first = values.data() + (is_cubic ? 3 * key + index : key) * width;
    return Numbers(first, first + width);
  };
  const auto value = [&](std::size_t key) { return part(key, 1); };
  const double t = at.fraction, t2 = t * t, t3 = t2 * t;
  if (at.seconds == 0 || interpolation == "STEP") return value(at.key);
  if (is_cubic) {
    const Numbers values_part =
        weighted_sum(2 * t3 - 3 * t2 + 1, value(at.key), 3 * t2 - 2 * t3, value(at.key + 1));
    const Numbers tangents_part =
        weighted_sum(t3 - 2 * t2 + t, part(at.key, 2), t3 - t2, part(at.key + 1, 0));
    return weighted_sum(1, values_part, at.seconds, tangents_part);
  }
  if (rotates) return slerp(unit(value(at.key)), unit(value(at.key + 1)), t);
  return weighted_sum(1 - t, value(at.key), t, value(at.key + 1));
}

/// Puts nodes where animations have them at a time.
class Poser {
 public:
  Poser(File& file, float time) : file_(file), time_(time) {}

  /// Whether the animation moves nothing that one before it has moved.
  bool is_free(const tinygltf::Animation& animation) const {
    return std::ranges::none_of(animation.channels, [&](const auto& channel) {
      return played_.contains({channel.target_node, channel.target_path});
    });
  }

  void play(int index) {
    const tinygltf::Animation& animation = file_.model.animations[static_cast<std::size_t>(index)];
    for (std::size_t i = 0; i < animation.channels.size(); ++i) {
      play(animation, animation.channels[i], fmt::format("animations[{}].channels[{}]", index, i));
    }
  }

 private:
  static constexpr const char* instead = "the channel is left out";

  /// Of a channel that cannot be used; `kind` as for File::report_value.
  template <class... Values>
  void lose(const std::string& place, const char* kind, fmt::format_string<Values...> text,
            Values&&... values) {
    file_.report_value(place, kind, "{}: {}", fmt::format(text, std::forward<Values>(values)...),
                       instead);
  }

  void play(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel,
            const std::string& place) {
    const auto property = std::ranges::find(properties, channel.target_path, &Property::name);
    if (property == std::end(properties)) {
      return lose(place, "path", "path '{:.40}': expected translation, rotation, scale or weights",
                  channel.target_path);
    }
    // Without a node the target is an extension's.
    if (channel.target_node == no_object ||
        !file_.has(file_.model.nodes, channel.target_node, "nodes", place + ".target", instead) ||
        !file_.has(animation.samplers, channel.sampler, "samplers", place, instead)) {
      return;
    }
    tinygltf::Node& node = file_.model.nodes[static_cast<std::size_t>(channel.target_node)];
    const std::string target = node_place(channel.target_node);
    const bool moves = property->name != "weights";
    if (moves && !node.matrix.empty()) {
      return lose(place, "matrix", "matrix: {} has one and cannot be animated", target);
    }
    const std::size_t width =
        moves ? static_cast<std::size_t>(property->components) : count_targets(node);
    if (width == 0) return lose(place, "weights", "weights: {} has no morph targets", target);
    if (!played_.insert({channel.target_node, property->name}).second) {
      return lose(place, "twice", "twice: {}.{} is animated already", target, property->name);
    }
    const auto& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
    if (auto value = evaluate(sampler, *property, width, place)) {
      node.*property->values = std::move(*value);
    }
  }

  std::size_t count_targets(const tinygltf::Node& node) const {
    const auto& meshes = file_.model.meshes;
    if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= meshes.size()) return 0;
    const auto& primitives = meshes[static_cast<std::size_t>(node.mesh)].primitives;
    return primitives.empty() ? 0 : primitives[0].targets.size();
  }

  std::optional<Numbers> evaluate(const tinygltf::AnimationSampler& sampler,
                                  const Property& property, std::size_t width,
                                  const std::string& place) {
    const std::string& interpolation = sampler.interpolation;
    const bool is_cubic = interpolation == "CUBICSPLINE", rotates = property.name == "rotation";
    if (!is_cubic && interpolation != "LINEAR" && interpolation != "STEP") {
      lose(place, "interpolation", "interpolation '{:.40}': expected STEP, LINEAR or CUBICSPLINE",
           interpolation);
      return std::nullopt;
    }
    const KeyTime at = time_among(sampler.input, place);
    if (at.keys == 0) return std::nullopt;
    const std::vector<float> values =
        read(sampler.output, property.components, place + ".sampler.output");
    const std::size_t expected = at.keys * width * (is_cubic ? 3 : 1);
    if (values.size() != expected) {
      const auto components = static_cast<std::size_t>(property.components);
      lose(place, "output", "output has {} elements, expected {} for {} keys",
           values.size() / components, expected / components, at.keys);
      return std::nullopt;
    }
    Numbers result = interpolate(at, interpolation, values, width, rotates);
    const bool is_finite =
        std::ranges::all_of(result, [](double x) { return std::isfinite(static_cast<float>(x)); });
    if (is_finite && !(rotates && dot(result, result) == 0)) return result;
    lose(place, "value", "value at {} s: expected finite numbers{}", time_,
         rotates ? " and a rotation that is not zero" : "");
    return std::nullopt;
  }

  /// Channels share keys. No keys, and a report, where they cannot be used.
  KeyTime time_among(int input, const std::string& place) {
    if (const auto known = times_.find(input); known != times_.end()) return known->second;
    KeyTime& result = times_[input];
    const std::vector<float> keys = read(input, 1, place + ".sampler.input");
    if (keys.empty()) lose(place, "keys", "keys: there are none");
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!std::isfinite(keys[i])) {
        lose(place, "key", "key {} is {}: expected seconds", i, keys[i]);
        return result;
      }
      if (i > 0 && keys[i] < keys[i - 1]) {
        lose(place, "order", "order of keys: key {} is {} s after {} s, expected ascending ones", i,
             keys[i], keys[i - 1]);
        return result;
      }
      if (i > 0 && keys[i] == keys[i - 1]) {
        file_.report_value(place, "equal", "equal keys {} and {}: the later one counts", i - 1, i);
      }
    }
    return result = find_key(keys, time_);
  }

  std::vector<float> read(int accessor, int components, const std::string& place) {
    std::vector<float> values = read_floats(file_, accessor, components, place);
    numbers_ += values.size();
    if (numbers_ > max_numbers) {
      file_.fail(place, "more than {} numbers in the channels of a file", max_numbers);
    }
    return values;
  }

  File& file_;
  float time_;
  std::size_t numbers_ = 0;                            ///< read so far
  std::map<int, KeyTime> times_;                       ///< by accessor
  std::set<std::pair<int, std::string_view>> played_;  ///< node and property
};

/// "0 'Walk', 1 'Run'"
std::string list_of(const std::vector<tinygltf::Animation>& animations) {
  std::string list;
  for (std::size_t i = 0; i < animations.size() && list.size() < longest_message; ++i) {
    list += fmt::format("{}{} '{:.40}'", i == 0 ? "" : ", ", i, animations[i].name);
  }
  return list;
}

/// The animation of this name, or else of this number.
int find_animation(const File& file, const std::string& choice) {
  const auto& animations = file.model.animations;
  const auto named = std::ranges::find(animations, choice, &tinygltf::Animation::name);
  if (named != animations.end()) return static_cast<int>(named - animations.begin());
  int number = -1;
  const char* const end = choice.data() + choice.size();
  const bool is_number = std::from_chars(choice.data(), end, number).ptr == end;
  if (is_number && number >= 0 && static_cast<std::size_t>(number) < animations.size()) {
    return number;
  }
  file.fail("animations", "--animation {:.80}: expected name or number of one of {}", choice,
            list_of(animations));
}

}  // namespace

void pose_nodes(File& file, const LoadOptions& options, float after_s) {
  const auto& animations = file.model.animations;
  if (animations.empty()) {
    if (options.time) file.report("", "no animations: --time has no effect");
    return;
  }
  if (!options.time) {
    file.report(
        "animations",
        "animations are ignored: everything is as its nodes place it; --time evaluates them");
    return;
  }
  Poser poser(file, *options.time + after_s);
  if (!options.animation.empty()) return poser.play(find_animation(file, options.animation));
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    if (poser.is_free(animations[i])) {
      poser.play(static_cast<int>(i));
    } else {
      ++left_out;
    }
  }
  if (left_out == 0 || after_s > 0.0f) return;
  file.note(fmt::format(
      "{} of {} animations move what one before them moves and are left out: --animation takes "
      "one of {}",
      left_out, animations.size(), list_of(animations)));
}

MovingNodes place_moving_nodes(File& file, const LoadOptions& options) {
  if (!options.shutter) {
    pose_nodes(file, options);
    return {place_nodes(file), {}};
  }
  if (!options.time) file.fail("", "--shutter: expected --time, when it opens");
  const std::vector<tinygltf::Node> nodes = file.model.nodes;
  const auto seconds = [&](std::size_t i) {
    return *options.shutter * static_cast<float>(i) / shutter_steps;
  };
  MovingNodes result;
  result.later.resize(shutter_steps);
  std::vector<std::vector<PlacedNode>> at(shutter_steps + 1);
  for (std::size_t i = shutter_steps + 1; i-- > 0;) {  // what it opens on comes last and stays
    file.model.nodes = nodes;
    pose_nodes(file, options, seconds(i));
    at[i] = place_nodes(file);
    if (i == 0) break;
    MovingNodes::Then& then = result.later[i - 1];
    for (const PlacedNode& node : at[i]) {
      const auto& weights = file.model.nodes[static_cast<std::size_t>(node.node)].weights;
      if (!weights.empty()) then.weights[node.node] = weights;
      if (!file.model.skins.empty()) then.places[node.node] = node.to_world;
    }
  }
  result.nodes = at[0];
  bool lamps = false;
  for (std::size_t n = 0; n < result.nodes.size(); ++n) {
    PlacedNode& node = result.nodes[n];
    std::vector<TransformKey> keys;
    bool moves = false;
    for (std::size_t i = 0; i <= shutter_steps; ++i) {
      const auto& then = at[i];
      if (n >= then.size() || then[n].node != node.node) break;  // some overflow at times
      keys.push_back({seconds(i), then[n].to_world});
      moves = moves || keys.back().to_world != node.to_world;
    }
    if (!moves) continue;
    node.keys = std::move(keys);
    const auto& source = file.model.nodes[static_cast<std::size_t>(node.node)];
    lamps = lamps || find_extension(source.extensions, "KHR_lights_punctual") != nullptr;
  }
  if (lamps)
    file.report("animations",
                "--shutter: lights without extent stand as they are when the shutter opens");
  return result;
}

}  // namespace pt::gltf
