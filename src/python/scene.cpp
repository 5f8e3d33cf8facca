// Scene in Python.
#include <fmt/format.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/render/calibration.h"
#include "common/error/error.h"
#include "common/image/codecs/image_io.h"
#include "python/arrays.h"
#include "python/module.h"
#include "python/scene_object.h"
#include "python/unlocked.h"

namespace pt::python {

namespace nb = nanobind;

std::vector<std::string> Warnings::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

void Warnings::give() {
  const std::vector<std::string> messages = take();
  if (messages.empty()) return;
  nb::object warn;
  run_python([&] { warn = nb::module_::import_("ptexp._errors").attr("warn"); });
  for (const std::string& message : messages) {
    const nb::str text(message.c_str(), message.size());
    run_python([&] { warn(text); });
  }
}

namespace {

std::vector<Setting> settings_of(const Words& words) {
  const auto& list = option_list();
  std::vector<Setting> settings;
  for (const auto& [keyword, value] : words) {
    const auto entry = std::ranges::find(list, keyword, option_key);
    if (entry == list.end()) throw Error(fmt::format("--{}: no such option", keyword));
    settings.push_back({&*entry, value});
  }
  return settings;
}

}  // namespace

RenderCommand command_of(const Words& words) { return make_render_command(settings_of(words)); }

std::unique_ptr<SceneObject> SceneObject::load(const Words& words) {
  Warnings warnings;
  std::unique_ptr<SceneObject> scene(new SceneObject);
  {
    const Unlocked unlocked;
    scene->session_ = std::make_unique<RenderSession>(command_of(words), warnings.collector());
    scene->list_parameters();
  }
  warnings.give();
  return scene;
}

SceneObject::Rendered SceneObject::render(const Words& words, nb::object progress, bool on_device) {
  const RenderCommand command = command_of(words);
  Warnings warnings;
  RenderResult result;
  nb::object raised = run_interruptible(
      [&](WorkState& state) {
        const std::lock_guard turn(mutex_);
        MeasureHooks hooks;
        hooks.progress = [&state](std::uint64_t done, std::uint64_t total) {
          state.done = done, state.total = total;
        };
        hooks.stop = [&state] { return state.stop.load(); };
        result = session_->render(command, hooks, warnings.collector(), on_device);
      },
      std::move(progress));
  return {std::make_unique<ImageObject>(std::move(result)), std::move(raised), warnings.take()};
}

SceneObject::Advised SceneObject::advise(const Words& words, double limit_s) {
  AdviceRequest request{settings_of(words), limit_s, {}, {}};
  std::optional<Advice> advice;
  nb::object raised = run_interruptible(
      [&](WorkState& state) {
        const std::lock_guard turn(mutex_);
        request.stop = [&state] { return state.stop.load(); };
        advice = pt::advise(*session_, request);
      },
      nb::none());
  return {std::move(advice), std::move(raised)};
}

std::unique_lock<std::mutex> SceneObject::lock() {
  const Unlocked unlocked;  // a render may hold it for long
  return std::unique_lock(mutex_);
}

std::vector<Decision> SceneObject::plan(const Words& words) {
  const RenderCommand command = command_of(words);
  const Unlocked unlocked;
  const std::lock_guard turn(mutex_);
  return session_->plan(command);
}

std::vector<float> SceneObject::get(std::size_t parameter) {
  const auto turn = lock();
  return parameters_.at(parameter).get(session_->scene());
}

void SceneObject::set(std::size_t parameter, std::span<const float> values) {
  const auto turn = lock();
  const SceneParameter& p = parameters_.at(parameter);
  const std::vector<float> old = p.get(session_->scene());
  if (values.size() != old.size())
    throw Error(fmt::format("{}: {} numbers; expected {}", p.name, values.size(), old.size()));
  const bool moves = p.get_keys && !p.get_keys(session_->scene()).empty();
  if (!moves && std::ranges::equal(values, old)) return;
  session_->change_scene(p.changes, [&](SceneData& scene) { p.set(scene, values); });
}

SceneObject::Keys SceneObject::get_keys(std::size_t parameter) {
  const auto turn = lock();
  const SceneParameter& p = parameters_.at(parameter);
  Keys keys;
  if (!p.get_keys) return keys;
  for (const TransformKey& key : p.get_keys(session_->scene()))
    keys.emplace_back(double{key.time}, numbers_of_key(p.shape, key.to_world));
  return keys;
}

void SceneObject::set_keys(std::size_t parameter, const Keys& keys) {
  const auto turn = lock();
  const SceneParameter& p = parameters_.at(parameter);
  std::vector<TransformKey> own;
  for (const auto& [time, numbers] : keys)
    own.push_back({static_cast<float>(time),
                   affine_of_key(p.shape, numbers, fmt::format("{}: key {}", p.name, own.size()))});
  const std::vector<TransformKey> old = p.get_keys(session_->scene());
  if (own == old) return;
  session_->change_scene(p.changes, [&](SceneData& scene) { p.set_keys(scene, own); });
}

nb::dict SceneObject::defaults() const {
  const SceneDefaults& d = session_->scene().defaults;
  nb::dict result;
  const auto note = [&](const char* name, const std::optional<int>& value) {
    if (value) result[name] = *value;
  };
  note("width", d.width), note("height", d.height), note("spp", d.spp);
  note("max_depth", d.max_depth), note("rr", d.rr_depth);
  return result;
}

namespace {

/// (name, shape) of each.
nb::list parameters(const SceneObject& self) {
  nb::list list;
  for (const SceneParameter& p : self.parameters()) {
    nb::list shape;
    for (const std::size_t n : p.shape) shape.append(n);
    list.append(nb::make_tuple(text(p.name), nb::tuple(shape)));
  }
  return list;
}

nb::list plan(SceneObject& self, const Words& words) {
  nb::list list;
  for (const Decision& d : self.plan(words)) {
    nb::dict decision;
    decision["option"] = text(d.option);
    decision["value"] = text(d.value);
    decision["reason"] = text(d.reason);
    list.append(decision);
  }
  return list;
}

nb::dict way_dict(const AdvisedWay& way) {
  nb::dict options, result;
  for (const auto& [name, value] : way.options)
    options[text(option_key(find_option(name)))] = text(value);
  result["options"] = options;
  result["mode"] = text(way.mode);
  result["total_ms"] = way.total_ms;
  result["times_as_fast"] = nb::make_tuple(way.ratio, way.low, way.high);
  result["word"] = text(way.word);
  nb::dict stages;
  for (const StageTime& stage : way.run.stages) stages[text(stage.stage)] = stage.time_ms;
  result["stages_ms"] = stages;
  return result;
}

/// None if it ended before anything was measured; and the exception that was raised meanwhile.
nb::tuple advise(SceneObject& self, const Words& words, double limit_s) {
  auto [advice, raised] = self.advise(words, limit_s);
  if (!advice) return nb::make_tuple(nb::none(), raised);
  nb::dict result;
  nb::list ways;
  for (const AdvisedWay& way : advice->ways) ways.append(way_dict(way));
  result["default"] = way_dict(advice->standard);
  result["ways"] = ways;
  result["best"] = way_dict(advice->best());
  result["text"] = text(advice_text(*advice));
  result["device"] = text(advice->standard.run.device);
  result["tried"] = advice->tried;
  result["rounds"] = advice->rounds;
  result["samples"] = advice->work.samples;
  result["scale"] = advice->work.scale;
  result["seconds"] = advice->seconds;
  return nb::make_tuple(result, raised);
}

/// Stores what it measures. None if it was interrupted; and the exception that was raised
/// meanwhile.
nb::tuple calibrate(const Words& words) {
  CalibrationRequest request{.settings = settings_of(words), .stop = {}, .says = {}};
  std::optional<Calibration> found;
  std::string file;
  nb::object raised = run_interruptible(
      [&](WorkState& state) {
        request.stop = [&state] { return state.stop.load(); };
        found = pt::calibrate(request);
        if (found) file = store_calibration(*found);
      },
      nb::none());
  if (!found) return nb::make_tuple(nb::none(), raised);
  nb::dict result, constants;
  for (const PlanConstantInfo& info : plan_constant_table)
    if (is_measured(found->constants, info.value))
      constants[info.name] = found->constants.*info.value;
  nb::list kept;
  for (const std::string& line : found->kept) kept.append(text(line));
  result["file"] = text(file);
  result["constants"] = constants;
  result["kept"] = kept;
  result["text"] = text(calibration_text(*found));
  result["seconds"] = found->seconds;
  return nb::make_tuple(result, raised);
}

/// The array of a mesh, of floats.
nb::object get_rows(SceneObject& self, std::size_t parameter) {
  const auto& shape = self.parameters().at(parameter).shape;
  return array_of(self.get(parameter), {shape.at(0), shape.at(1)});
}

void set_rows(SceneObject& self, std::size_t parameter, const FloatsIn& rows) {
  const SceneParameter& p = self.parameters().at(parameter);
  if (rows.shape(0) != p.shape.at(0) || rows.shape(1) != p.shape.at(1))
    throw Error(fmt::format("{}: an array of {} x {}; expected {} x {}", p.name, rows.shape(0),
                            rows.shape(1), p.shape[0], p.shape[1]));
  self.set(parameter, {rows.data(), rows.size()});
}

}  // namespace

void add_scene(nb::module_& m) {
  nb::class_<SceneObject>(m, "Scene")
      .def("render", &SceneObject::render, nb::arg("words"), nb::arg("progress").none(),
           nb::arg("on_device"))
      .def("plan", plan)
      .def("advise", advise, nb::arg("words"), nb::arg("limit_s"))
      .def_prop_ro("name", [](const SceneObject& self) { return text(self.name()); })
      .def("defaults", &SceneObject::defaults)
      .def("parameters", parameters)
      .def("get", &SceneObject::get)
      .def("set", [](SceneObject& self, std::size_t parameter,
                     const std::vector<float>& values) { self.set(parameter, values); })
      .def("get_keys", &SceneObject::get_keys)
      .def("set_keys", &SceneObject::set_keys)
      .def("get_rows", get_rows)
      .def("set_rows", set_rows);
  m.def("calibrate", calibrate, nb::arg("words"));
  m.def("load", &SceneObject::load, nb::arg("words"));
  m.def("check_output", check_image_path);  // before any work
}

}  // namespace pt::python
