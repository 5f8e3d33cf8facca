// What a page may ask for, and what it is told otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/film/aov.h"
#include "view/change_settings.h"
#include "view/view_site.h"

namespace {

using namespace pt;

std::string refusal(std::string_view json) {
  try {
    read_change(json);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ChangeSettings, ReadsWhatIsThere) {
  const SettingsChange change = read_change(
      R"({"orbit": {"yaw": -10.5, "pitch": 5, "zoom": 2}, "mode": "split", "exposure": 1.5})");
  EXPECT_EQ(change.orbit, (Orbit{-10.5, 5, 2}));
  EXPECT_EQ(change.modes, (std::vector{Mode::wavefront, Mode::megakernel}));
  EXPECT_EQ(change.exposure, 1.5f);
  const SettingsChange none = read_change("{}");
  EXPECT_FALSE(none.orbit || none.modes || none.size || none.scale || none.spp || none.is_paused ||
               none.layer || none.exposure || none.curve || none.time || none.resets_parameters);
  EXPECT_TRUE(none.parameters.empty());
  const SettingsChange rest = read_change(
      R"({"size": [640, 480], "scale": 0.5, "spp": 99, "paused": true, "layer": "depth",
          "curve": "agx", "parameters": {"a.b": 2, "c.d": [1, 2.5, -3]}})");
  EXPECT_EQ(rest.size, (ImageSize{640, 480}));
  EXPECT_EQ(rest.scale, 0.5);
  EXPECT_EQ(rest.spp, 99);
  EXPECT_EQ(rest.is_paused, true);
  EXPECT_EQ(rest.layer, "depth");
  EXPECT_EQ(rest.curve, ToneCurve::agx);
  EXPECT_EQ(rest.parameters, (ParameterValues{{"a.b", {2}}, {"c.d", {1, 2.5f, -3}}}));
  EXPECT_FALSE(rest.resets_parameters);
  EXPECT_TRUE(read_change(R"({"parameters": null})").resets_parameters);
  EXPECT_EQ(read_change(R"({"time": 0.25})").time.value(), std::optional(0.25f));
  EXPECT_FALSE(read_change(R"({"time": null})").time.value().has_value());
  EXPECT_EQ(read_change(R"({"mode": "serial"})").modes, std::vector{Mode::serial});
}

TEST(ChangeSettings, NamesTheKeyAndWhatWasExpected) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "settings: expected a JSON object"},
      {"[]", "settings: expected a JSON object"},
      {"{\"exposure\": 1", "settings: expected a JSON object"},
      {R"({"exposure": "1"})", "\"exposure\": expected a number from -100 to 100"},
      {R"({"exposure": 101})", "\"exposure\": expected a number from -100 to 100"},
      {R"({"exposure": 1e999})", "settings: expected a JSON object"},
      {R"({"time": "now"})", "\"time\": expected a number from -1000000000 to 1000000000"},
      {R"({"orbit": 1})", "\"orbit\": expected an object with \"yaw\", \"pitch\" and \"zoom\""},
      {R"({"orbit": {"zoom": 0}})", "\"zoom\": expected a number from 0.001 to 1000"},
      {R"({"orbit": {"pitch": null}})", "\"pitch\": expected a number from -180 to 180"},
      {R"({"orbit": {"roll": 1}})",
       "\"roll\": no such key; expected \"yaw\", \"pitch\" or \"zoom\""},
      {R"({"mode": 3})", "\"mode\": expected one of auto, serial, megakernel, wavefront, split"},
      {R"({"mode": "fast"})",
       "\"mode\": expected one of auto, serial, megakernel, wavefront, split"},
      {R"({"scene": "x"})",
       "\"scene\": no such key; expected one of \"orbit\", \"mode\", \"size\", \"scale\", "
       "\"spp\", \"paused\", \"layer\", \"exposure\", \"curve\", \"time\", "
       "\"parameters\""},
      {R"({"size": [640]})", "\"size\": expected width and height, such as [640, 480]"},
      {R"({"size": 640})", "\"size\": expected width and height, such as [640, 480]"},
      {R"({"size": [640.5, 3]})", "\"size\": expected a whole number from 1 to 8192"},
      {R"({"spp": "9"})", "\"spp\": expected a whole number from 1 to 2147483647"},
      {R"({"paused": 1})", "\"paused\": expected true or false"},
      {R"({"curve": "filmic"})", "\"curve\": expected one of srgb, neutral, agx, aces"},
      {R"({"parameters": [1]})", "\"parameters\": expected an object of names and values, or null"},
      {R"({"parameters": {"a": ["1"]}})", "\"parameters\": \"a\": expected numbers"},
      {R"({"parameters": {"a": [[1]]}})", "\"parameters\": \"a\": expected numbers"},
      {R"({"parameters": {"a": 1e39}})", "\"parameters\": \"a\": expected numbers"},
      {R"({"parameters": {"a": null}})", "\"parameters\": \"a\": expected numbers"}};
  for (const auto& [json, message] : cases) EXPECT_EQ(refusal(json), message) << json;
}

TEST(ChangeSettings, NamesTheLayersThatThereAre) {
  const std::string said = refusal(R"({"layer": "alpha"})");
  for (const AovInfo& info : aov_table) {
    EXPECT_NE(said.find(info.name), std::string::npos) << said;
    EXPECT_EQ(layer_bit(info.name), info.bit);
  }
  EXPECT_EQ(said.find("\"layer\": expected one of color, albedo"), 0u) << said;
  EXPECT_EQ(layer_bit("color"), 0u);
  EXPECT_EQ(layer_bit("alpha"), std::nullopt);
  EXPECT_EQ(layer_names().size(), aov_table.size() + 1);
}

TEST(ChangeSettings, TakesBothEndsOfWholeNumbers) {
  EXPECT_EQ(refusal(R"({"size": [1, 8192]})"), "");
  EXPECT_NE(refusal(R"({"size": [0, 8192]})"), "");
  EXPECT_NE(refusal(R"({"size": [1, 8193]})"), "");
  EXPECT_EQ(refusal(R"({"spp": 2147483647})"), "");
  EXPECT_NE(refusal(R"({"spp": 2147483648})"), "");
  EXPECT_NE(refusal(R"({"spp": 18446744073709551615})"), "");
  EXPECT_NE(refusal(R"({"spp": 0})"), "");
  EXPECT_NE(refusal(R"({"spp": -1})"), "");
}

TEST(ChangeSettings, AScaledImageHasPixels) {
  EXPECT_EQ(scaled({640, 480}, 0.5), (ImageSize{320, 240}));
  EXPECT_EQ(scaled({3, 1}, 0.25), (ImageSize{1, 1}));
  EXPECT_EQ(scaled({8000, 5}, 4), (ImageSize{8192, 20}));
}

TEST(ChangeSettings, TakesBothEndsOfEachRange) {
  const std::pair<const char*, std::pair<double, double>> ranges[] = {
      {R"({{"exposure": {}}})", {-100, 100}},
      {R"({{"scale": {}}})", {1.0 / 16, 4}},
      {R"({{"orbit": {{"yaw": {}}}}})", {-1e6, 1e6}},
      {R"({{"orbit": {{"pitch": {}}}}})", {-180, 180}},
      {R"({{"orbit": {{"zoom": {}}}}})", {1e-3, 1e3}}};
  for (const auto& [form, ends] : ranges) {
    const auto said = [form = form](double x) {
      return refusal(fmt::format(fmt::runtime(form), x));
    };
    for (const double end : {ends.first, ends.second}) EXPECT_EQ(said(end), "") << form << end;
    EXPECT_NE(said(ends.first - 1e-3), "") << form;
    EXPECT_NE(said(ends.second + 1e-3), "") << form;
  }
  EXPECT_EQ(read_change(R"({"orbit": {"yaw": 7}})").orbit, (Orbit{7, 0, 1}));
  EXPECT_EQ(mode_name({Mode::megakernel}), "megakernel");
  EXPECT_EQ(mode_name({Mode::wavefront, Mode::megakernel}), "split");
}

TEST(Viewers, NoMoreThanSoMany) {
  Viewers viewers;
  for (std::size_t i = 0; i < Viewers::most; ++i) viewers.saw(std::to_string(i), 0);
  viewers.saw("one more", 100);
  EXPECT_FALSE(viewers.any(100)) << "was not counted";
  viewers.saw("one more", 100);
  EXPECT_TRUE(viewers.any(100)) << "there is room again";
  viewers.left("one more");
  EXPECT_FALSE(viewers.any(100));
}

TEST(Viewers, AreForgottenWhenTheyAreSilent) {
  Viewers viewers;
  EXPECT_FALSE(viewers.any(0));
  viewers.saw("a", 10);
  viewers.saw("b", 11);
  EXPECT_TRUE(viewers.any(12));
  viewers.left("b");
  EXPECT_TRUE(viewers.any(10 + Viewers::patience_s));
  EXPECT_FALSE(viewers.any(10.1 + Viewers::patience_s));
  for (std::size_t i = 0; i < 2 * Viewers::most; ++i) viewers.saw(std::to_string(i), 20);
  EXPECT_TRUE(viewers.any(20));
  viewers.saw("0", 30);
  EXPECT_TRUE(viewers.any(30));
  EXPECT_FALSE(viewers.any(40));
}

}  // namespace
