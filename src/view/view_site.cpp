#include "view/view_site.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>

#include "app/terminal/process.h"
#include "common/error/terminal.h"
#include "common/image/codecs/image_codec.h"
#include "common/options/option_names.h"
#include "common/platform/steady_seconds.h"
#include "view/change_settings.h"

namespace pt {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// A request for news is answered after this time at the latest, so that a viewer who is gone is
/// noticed soon.
constexpr double longest_wait_s = 1.0;
constexpr std::size_t longest_name = 64;

HttpReply nothing_there() { return text_reply(404, "nothing is here"); }

/// Takes the same time for a wrong token as for the right one.
bool is_same_token(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned>(a[i] ^ b[i]);
  return difference == 0;
}

/// A browser leaves out port 80.
std::vector<std::string> hosts_of(int port) {
  std::vector<std::string> hosts;
  for (const char* const name : {"127.0.0.1", "localhost"}) {
    hosts.push_back(fmt::format("{}:{}", name, port));
    if (port == 80) hosts.push_back(name);
  }
  return hosts;
}

bool contains(const std::vector<std::string>& list, std::string_view text) {
  return std::ranges::find(list, text) != list.end();
}

std::string parameter(const HttpRequest& request, const char* name) {
  const auto found = request.query.find(name);
  return found == request.query.end() ? "" : found->second;
}

const char* name_of_status(LiveStatus status) {
  constexpr const char* names[] = {"rendering", "idle", "paused", "done", "failed"};
  return names[static_cast<int>(status)];
}

OrderedJson view_json(const LiveView& view) {
  OrderedJson json = {{"mode", to_string(view.mode)},   {"samples", view.samples},
                      {"image", view.image_number},     {"pass_samples", view.pass_samples},
                      {"pass_ms", view.pass_ms},        {"msamples_per_s", view.msamples_per_s},
                      {"kernel_ms", view.kernel_ms},    {"wall_ms", view.wall_ms},
                      {"used", view.decision.value},    {"why", view.decision.reason},
                      {"stages", OrderedJson::object()}};
  for (const StageTime& stage : view.stages) json["stages"][stage.stage] = stage.time_ms;
  json["error"] = view.relative_error ? OrderedJson(*view.relative_error) : OrderedJson();
  return json;
}

OrderedJson ratio_json(const std::optional<TimeRatio>& ratio) {
  if (!ratio) return nullptr;
  return {{"value", ratio->value},
          {"low", ratio->low},
          {"high", ratio->high},
          {"rounds", ratio->rounds}};
}

/// A file's name need not be UTF-8.
std::string json_text(const OrderedJson& json) {
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

std::string state_json(const LiveState& state, const LiveRender& live) {
  OrderedJson views = OrderedJson::array();
  for (const LiveView& view : state.views) views.push_back(view_json(view));
  const LiveSettings& settings = state.settings;
  const Orbit& orbit = settings.orbit;
  const PitchRange pitch = pitch_range(live.camera());
  const CameraParameters camera = orbit_camera(live.camera(), orbit);
  return json_text(
      {{"version", state.version},
       {"scene", live.scene()},
       {"device", live.device()},
       {"spp", state.spp},
       {"status", name_of_status(state.status)},
       {"error", state.error},
       {"mode", mode_name(settings.modes)},
       {"size", {settings.size.width, settings.size.height}},
       {"scale", settings.scale},
       {"shutter",
        live.shutter() ? OrderedJson{live.shutter()->open, live.shutter()->close} : OrderedJson()},
       {"time", settings.time ? OrderedJson(*settings.time) : OrderedJson()},
       {"paused", state.is_paused},
       {"layer", state.display.layer},
       {"exposure", state.display.exposure},
       {"curve", to_string(state.display.curve)},
       {"orbit", {{"yaw", orbit.yaw}, {"pitch", orbit.pitch}, {"zoom", orbit.zoom}}},
       {"pitch_range", {pitch.least, pitch.most}},
       {"camera",
        {{"options", camera_options(camera)}, {"xml", camera_xml(camera, settings.size)}}},
       {"parameters", OrderedJson(settings.parameters)},
       {"ratio", ratio_json(state.ratio)},
       {"layers", layer_names()},
       {"views", views}});
}

/// The scene's name as a file's.
std::string file_name(const std::string& scene, const std::string& ending) {
  std::string name = scene.substr(scene.find_last_of('/') + 1);
  if (const std::size_t dot = name.rfind('.'); dot != std::string::npos && dot > 0)
    name.resize(dot);
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  return name + "." + ending;
}

const LiveView* view_of(const LiveState& state, const std::string& mode) {
  for (const LiveView& view : state.views)
    if (view.image && to_string(view.mode) == mode) return &view;
  return nullptr;
}

}  // namespace

std::string random_token() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
    throw Error("view: the system gave no random numbers for the page's address");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

ViewSite::ViewSite(LiveRender& live, std::string token, int port, std::function<double()> clock)
    : live_(live), token_(std::move(token)), hosts_(hosts_of(port)), clock_(std::move(clock)) {}

/// The address below /TOKEN/; "/" where it is not below that.
std::string ViewSite::name_of(const HttpRequest& request) const {
  const std::string_view path = request.path;
  const std::size_t length = token_.size() + 2;
  if (path.size() < length || path.front() != '/' || path[length - 1] != '/' ||
      !is_same_token(path.substr(1, token_.size()), token_))
    return "/";
  return std::string(path.substr(length));
}

std::optional<HttpReply> ViewSite::refuse(const HttpRequest& request) {
  if (!contains(hosts_, request.host))
    return text_reply(403, fmt::format("Host: expected {}", hosts_.front()));
  const std::string name = name_of(request);
  constexpr std::array readable = {"", "state", "image", "save", "parameters"};
  const bool is_get =
      request.method == "GET" && std::ranges::find(readable, name) != readable.end();
  const bool is_post = request.method == "POST" && (name == "settings" || name == "leave");
  if (!is_get && !is_post) return nothing_there();
  constexpr std::string_view scheme = "http://";
  const bool is_own =
      request.origin.starts_with(scheme) && contains(hosts_, request.origin.substr(scheme.size()));
  if (is_post && !request.origin.empty() && !is_own)
    return text_reply(403, "Origin: expected the page itself");
  return std::nullopt;
}

HttpReply ViewSite::answer(const HttpRequest& request) {
  const std::string name = name_of(request);
  if (name.empty()) return page();
  if (name == "state") return state(request);
  if (name == "image") return image(request);
  if (name == "save") return save(request);
  if (name == "parameters") return parameters();
  if (name == "settings") return settings(request);
  return name == "leave" ? leave(request) : nothing_there();
}

HttpReply ViewSite::page() const {
  const std::string nonce = random_token();
  std::string html(page_html());
  constexpr std::string_view placeholder = "NONCE";
  for (std::size_t at = 0; (at = html.find(placeholder, at)) != std::string::npos;)
    html.replace(at, placeholder.size(), nonce);
  const std::string policy = fmt::format(
      "default-src 'none'; script-src 'nonce-{0}'; style-src 'nonce-{0}'; connect-src 'self'; "
      "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      nonce);
  return {200, "text/html; charset=utf-8", html, {{"Content-Security-Policy", policy}}};
}

HttpReply ViewSite::state(const HttpRequest& request) {
  const std::string viewer = parameter(request, "viewer"), after = parameter(request, "after");
  std::uint64_t version = 0;
  const auto [end, error] = std::from_chars(after.data(), after.data() + after.size(), version);
  if (!after.empty() && (error != std::errc() || end != after.data() + after.size()))
    return text_reply(400, "after: expected the version of a state");
  if (viewer.size() > longest_name)
    return text_reply(400, fmt::format("viewer: expected at most {} characters", longest_name));
  if (!viewer.empty()) {
    const std::lock_guard lock(viewers_mutex_);
    viewers_.saw(viewer, clock_());
    live_.set_watched(true);
  }
  const LiveState now = after.empty() ? live_.state() : live_.wait(version, longest_wait_s);
  return {200, "application/json", state_json(now, live_)};
}

HttpReply ViewSite::image(const HttpRequest& request) {
  const LiveState now = live_.state();
  const std::string mode = parameter(request, "mode");
  const LiveView* const view = view_of(now, mode);
  const auto is_mode = [&](const auto& one) { return one.name == mode; };
  if (std::ranges::none_of(enum_names<Mode>, is_mode)) return nothing_there();
  if (view == nullptr) return {.status = 204};
  const std::lock_guard lock(pictures_mutex_);
  Encoded& encoded = pictures_[view->mode];
  if (encoded.image_number != view->image_number || encoded.display != now.display) {
    const auto picture = make_picture(*view->image, now.display, view->image_samples);
    if (!picture) return {.status = 204};  // the first pass that has the layer is on its way
    const auto& range = picture->range;
    encoded = {view->image_number, now.display,
               encode_png_fast(picture->image, {.exposure = picture->exposure}),
               range ? fmt::format("{} {}", (*range)[0], (*range)[1]) : ""};
  }
  HttpReply reply{200, "image/png", encoded.png};
  if (!encoded.range.empty()) reply.headers["X-Range"] = encoded.range;
  return reply;
}

HttpReply ViewSite::save(const HttpRequest& request) const {
  const LiveState now = live_.state();
  const LiveView* const view = view_of(now, parameter(request, "mode"));
  const std::string form = parameter(request, "form");
  if (view == nullptr) return nothing_there();
  if (form != "png" && form != "exr") return text_reply(400, "form: expected png or exr");
  HttpReply reply{200, form == "png" ? "image/png" : "image/x-exr"};
  reply.headers["Content-Disposition"] =
      fmt::format("attachment; filename=\"{}\"", file_name(live_.scene(), form));
  const ImageMetadata header = live_.header_of(*view);
  if (form == "exr") {
    reply.body = exr_codec.encode(*view->image, header, {});
    return reply;
  }
  const auto picture = make_picture(*view->image, now.display, view->image_samples);
  if (!picture) return nothing_there();
  reply.body = png_codec.encode(picture->image, header, {.exposure = picture->exposure});
  return reply;
}

HttpReply ViewSite::parameters() const {
  OrderedJson list = OrderedJson::array();
  for (const LiveParameter& one : live_.parameters())
    list.push_back({{"name", one.parameter.name}, {"value", one.value}});
  return {200, "application/json", json_text(list)};
}

HttpReply ViewSite::settings(const HttpRequest& request) {
  const std::lock_guard lock(settings_mutex_);
  LiveSettings settings = live_.state().settings;
  try {
    const SettingsChange change = read_change(request.body);
    settings.orbit = change.orbit.value_or(settings.orbit);
    settings.modes = change.modes.value_or(settings.modes);
    settings.size = change.size.value_or(settings.size);
    settings.scale = change.scale.value_or(settings.scale);
    settings.time = change.time.value_or(settings.time);
    if (change.resets_parameters) settings.parameters.clear();
    for (const auto& [name, values] : change.parameters) settings.parameters[name] = values;
    live_.change(std::move(settings));
    live_.change_display(change);
    if (change.spp) live_.change_samples(*change.spp);
    if (change.is_paused) live_.set_paused(*change.is_paused);
  } catch (const Error& error) {
    return text_reply(400, error.what());
  }
  return {.status = 204};
}

HttpReply ViewSite::leave(const HttpRequest& request) {
  const std::lock_guard lock(viewers_mutex_);
  viewers_.left(parameter(request, "viewer"));
  live_.set_watched(viewers_.any(clock_()));
  return {.status = 204};
}

void ViewSite::look_for_viewers() {
  const std::lock_guard lock(viewers_mutex_);
  live_.set_watched(viewers_.any(clock_()));
}

int view_command(const ViewCommand& command) {
  HttpServer server(command.port);  // before the scene, which may take long
  const std::string token = random_token();
  LiveRender live(command.settings, print_warning);
  ViewSite site(live, token, server.port(), steady_seconds);
  const std::string address = fmt::format("http://127.0.0.1:{}/{}/", server.port(), token);
  if (!command.is_quiet) {
    print("{} on {}: open this address in a browser of this machine; Ctrl-C ends\n", live.scene(),
          live.device());
  }
  print("{}\n", address);
  flush_output();

  note_signals();
  server.serve(site, [&] {
    site.look_for_viewers();
    if (!interrupted()) return true;
    end_on_signal();  // another one does not wait
    live.end();       // who waits is answered
    return false;
  });
  print_notice("interrupted");
  return exit_code_of_signal();
}

}  // namespace pt
