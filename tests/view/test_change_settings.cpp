// What a page may ask for, and what it is told otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

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
  EXPECT_FALSE(read_change("{}").orbit);
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
      {R"({"orbit": 1})", "\"orbit\": expected an object with \"yaw\", \"pitch\" and \"zoom\""},
      {R"({"orbit": {"zoom": 0}})", "\"zoom\": expected a number from 0.001 to 1000"},
      {R"({"orbit": {"pitch": null}})", "\"pitch\": expected a number from -180 to 180"},
      {R"({"orbit": {"roll": 1}})",
       "\"roll\": no such key; expected \"yaw\", \"pitch\" or \"zoom\""},
      {R"({"mode": 3})", "\"mode\": expected one of auto, serial, megakernel, wavefront, split"},
      {R"({"mode": "fast"})",
       "\"mode\": expected one of auto, serial, megakernel, wavefront, split"},
      {R"({"scene": "x"})",
       "\"scene\": no such key; expected \"orbit\", \"mode\" or \"exposure\""}};
  for (const auto& [json, message] : cases) EXPECT_EQ(refusal(json), message) << json;
}

TEST(ChangeSettings, TakesBothEndsOfEachRange) {
  const std::pair<const char*, std::pair<double, double>> ranges[] = {
      {R"({{"exposure": {}}})", {-100, 100}},
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
