// verify, compare and merge, by what they print of images whose differences are known.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <regex>

#include "app/commands/commands.h"
#include "app/render/render_outputs.h"
#include "app/render/render_session.h"
#include "app/report/film_header.h"
#include "common/error/terminal.h"
#include "common/film/checkpoint.h"
#include "common/image/atomic_file.h"
#include "common/platform/build_info.h"
#include "temp_folder.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

/// What `command` prints.
template <class Action>
std::string printed(Action command) {
  flush_printed();
  testing::internal::CaptureStdout();
  command();
  flush_printed();
  return testing::internal::GetCapturedStdout();
}

RenderResult render(const std::vector<std::string>& arguments) {
  const auto command = std::get<RenderCommand>(parse_command_line(arguments));
  RenderSession session(command, {});
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  return session.render(command, hooks, {});
}

// A window of 59x37 pixels at 5,3: neither its rims nor its corner are multiples of anything.
TEST(Verify, FindsAPixelAtEachRimAndNamesIt) {
  const TempFolder folder;
  const RenderResult result =
      render({"--scene", "boxes", "--device", "cpu", "--width", "64", "--height", "48", "--spp",
              "2", "--max-depth", "3", "--crop", "5,3,64,40"});
  ASSERT_EQ(result.image.width, 59);
  ASSERT_EQ(result.image.height, 37);
  const std::string path = folder.file("a.exr");
  const VerifyCommand command{path, 1.0, {}};
  const auto verify = [&](const Image& image, int code) {
    write_image(path, image, result.header);
    return printed([&] { EXPECT_EQ(verify_command(command), code); });
  };
  const std::string all = path + ": 2183 pixels (100 %) of 2 samples rendered again on ";
  const std::string clean = verify(result.image, 0);
  EXPECT_TRUE(clean.starts_with(all) && clean.ends_with(": all bits are equal\n")) << clean;
  const int places[][2] = {{0, 0}, {58, 0}, {0, 36}, {58, 36}, {58, 17}, {31, 36}, {16, 16}};
  for (const auto& [x, y] : places) {
    Image changed = result.image;
    float& value = changed.rgb[3 * (static_cast<std::size_t>(y) * 59 + x) + 2];
    value = std::nextafter(value, 2.0f);
    const std::string text = verify(changed, 1);
    const std::string end = fmt::format(": 1 differ, the first at {},{}\n", 5 + x, 3 + y);
    EXPECT_TRUE(text.starts_with(all) && text.ends_with(end)) << text << end;
  }
}

// Windows of 16x16 pixels, at least the share that is asked for.
TEST(Verify, RendersItsShareOfThePixels) {
  const TempFolder folder;
  const RenderResult result = render({"--scene", "boxes", "--device", "cpu", "--width", "64",
                                      "--height", "48", "--spp", "2", "--max-depth", "3"});
  const std::string path = folder.file("a.exr");
  write_image(path, result.image, result.header);
  const std::pair<double, const char*> shares[] = {{0.5, ": 1536 pixels (50 %)"},
                                                   {0.51, ": 1792 pixels (58.3 %)"},
                                                   {1e-3, ": 256 pixels (8.33 %)"},
                                                   {0.25, ": 768 pixels (25 %)"}};
  for (const auto& [share, text] : shares) {
    const std::string said = printed([&, share = share] {
      EXPECT_EQ(verify_command({path, share, {}}), 0);
    });
    EXPECT_TRUE(said.starts_with(path + text)) << said;
  }
}

Image grey(float value) { return {4, 1, std::vector<float>(12, value)}; }

// One of twelve values is 0.5 + 0.25; by hand: sqrt(0.0625 / 12), 0.0625 / 0.26 / 12.
TEST(Compare, PrintsTheNumbersOfTwoImages) {
  const TempFolder folder;
  const std::string a = folder.file("a.exr"), b = folder.file("b.exr");
  Image image = grey(0.5f);
  write_image(b, image, {});
  image.rgb[7] = 0.75f;
  write_image(a, image, {});
  const auto compare = [&](double tolerance, int code) {
    return printed([&] { EXPECT_EQ(compare_command({a, b, tolerance}), code); });
  };
  const std::string text = compare(0.2, 1);
  const std::regex expected(
      "size                   4x1\n"
      "RMSE                   0\\.0721687836487\\d*\n"
      "relMSE                 0\\.02003205\\d*\n"
      "HDR-FLIP               0\\.\\d{6}\n"
      "largest difference     0\\.25\n"
      "differing pixels       1\n"
      "pixels past tolerance  1\n");
  EXPECT_TRUE(std::regex_match(text, expected)) << text;
  EXPECT_NE(compare(0.25, 0).find("pixels past tolerance  0\n"), std::string::npos);
  write_image(a, grey(0.5f), {});
  EXPECT_EQ(compare(0, 0),
            "size                   4x1\nRMSE                   0\nrelMSE                 0\n"
            "HDR-FLIP               0.000000\nlargest difference     0\n"
            "differing pixels       0\npixels past tolerance  0\n");
}

// One picture of radiance is enough for the comparison of radiance.
TEST(Compare, TakesTheFlipOfItsFormats) {
  const TempFolder folder;
  for (const char* name : {"a.exr", "b.png"}) write_image(folder.file(name), grey(0.5f), {});
  const auto flip_of = [&](const char* a, const char* b) {
    const std::string text = printed([&] { compare_command({folder.file(a), folder.file(b), 1}); });
    return text.substr(text.find("-FLIP") - 3, 3);
  };
  EXPECT_EQ(flip_of("a.exr", "a.exr"), "HDR");
  EXPECT_EQ(flip_of("a.exr", "b.png"), "HDR");
  EXPECT_EQ(flip_of("b.png", "a.exr"), "HDR");
  EXPECT_EQ(flip_of("b.png", "b.png"), "LDR");
}

TEST(FilmCommands, ReplaceNoFileThatTheyRead) {
  const TempFolder folder;
  const std::string a = folder.file("a.exr"), b = folder.file("b.exr"), link = folder.file("l.exr"),
                    hard = folder.file("h.exr");
  write_image(a, grey(0.5f), {});
  write_image(b, grey(0.25f), {});
  fs::create_symlink("a.exr", link);
  fs::create_hard_link(a, hard);
  const std::string before = read_text(a);
  const std::string around =
      folder.file("../" + fs::path(folder.file("")).parent_path().filename().string() + "/a.exr");
  for (const std::string& name : {a, link, hard, around}) {
    expect_error([&] { merge_command({name, {b, a}}); }, "merge " + name + ": is the file " + a);
    expect_error(
        [&] {
          compare_command({a, b, 0, name});
        },
        "--difference " + name + ": is the file");
    expect_error(
        [&] {
          compare_command({b, a, 0, name});
        },
        "--difference " + name + ": is the file");
    Options options;
    options.output = folder.file("new.exr");
    check_not_of_scene(options, {b, a});
    options.stats_file = name;
    expect_error([&] { check_not_of_scene(options, {b, a}); }, "--stats " + name);
    options.stats_file = "", options.csv_file = name;
    expect_error([&] { check_not_of_scene(options, {b, a}); }, "--csv " + name);
    options.csv_file = "", options.checkpoint.file = name;
    expect_error([&] { check_not_of_scene(options, {b, a}); }, "--checkpoint " + name);
    options.checkpoint.file = "", options.output = name;
    expect_error([&] { check_not_of_scene(options, {b, a}); }, "--output " + name);
    options.part = {1, 2};  // which has no image
    check_not_of_scene(options, {b, a});
  }
  EXPECT_EQ(read_text(a), before);
}

// Places are those of the whole image, not of its crop window.
TEST(Merge, NamesThePlacesOfACropWindow) {
  const TempFolder folder;
  const std::string a = folder.file("a.exr"), b = folder.file("b.exr"), out = folder.file("o.exr");
  render({"--scene", "boxes", "--device", "cpu", "--width", "40", "--height", "30", "--spp", "2",
          "--max-depth", "3", "--crop", "7,5,30,24", "--checkpoint", a});
  Checkpoint checkpoint = read_checkpoint(a);
  const ImagePlace whole{0, 0, 40, 30};
  const int places[][2] = {{7, 5}, {29, 5}, {7, 23}, {29, 23}, {18, 11}};
  for (const auto& [x, y] : places) {
    const std::size_t pixel = static_cast<std::size_t>(y - 5) * 23 + (x - 7);
    double& sum = checkpoint.film.pixels[pixel].sum[1];
    const double before = sum;
    sum += 1;
    write_checkpoint(b, checkpoint, {}, whole);
    sum = before;
    expect_error(
        [&] {
          merge_command({out, {a, b}});
        },
        fmt::format("pixel {},{}: differs between {} and {}, both of 2 samples", x, y, a, b));
  }
  checkpoint.film.pixels[24].samples = 3;  // the second of the second row
  expect_error([&] { write_checkpoint(b, checkpoint, {}, whole); },
               "pixel 8,6 has 3 samples: expected 2");
  checkpoint.film.clear();
  write_checkpoint(b, checkpoint, {}, whole);
  expect_error(
      [&] {
        merge_command({out, {b}});
      },
      "23x19 pixels at 7,5 have 0 of 2 samples: 100 % of the samples are missing");
  EXPECT_EQ(printed([&] {
              merge_command({out, {a}, false, true});
            }),
            "wrote " + out + ", of 1 file\n");
  EXPECT_EQ(read_checkpoint(out).film.samples(), 2u * 23 * 19);
}

// Of pixels that two files have all must be the same: which samples, statistics and layers, too.
TEST(Merge, RefusesOtherSamplesAndLayersOfAPixel) {
  const TempFolder folder;
  const std::string a = folder.file("a.exr"), b = folder.file("b.exr"), out = folder.file("o.exr");
  render({"--scene", "boxes", "--device", "cpu", "--width", "40", "--height", "30", "--spp", "2",
          "--max-depth", "3", "--aov", "depth,variance", "--checkpoint", a});
  const Checkpoint checkpoint = read_checkpoint(a);
  const auto expect_refused = [&](const auto& change, const std::string& message) {
    Checkpoint other = checkpoint;
    change(other.film);
    write_checkpoint(b, other, {}, {0, 0, 40, 30});
    expect_error([&] { merge_command({out, {a, b}}); }, message);
  };
  expect_refused([](ImageFilm& film) { film.features.back() += 1; }, b + ": other layers than in");
  expect_refused([](ImageFilm& film) { ++film.moments.back().rays; }, b + ": other layers than in");
  expect_refused(
      [](ImageFilm& film) {
        for (FilmPart& part : film.parts) part.first_sample = 1;
        for (FilmPixel& pixel : film.pixels) pixel.samples = 1;
      },
      b + ": has 1 samples of 40x30 pixels at 0,0, but " + a + " has 2");
}

// Counts of two parts together are those of the whole.
TEST(Merge, AddsTheCountsOfItsFiles) {
  const TempFolder folder;
  const std::string a = folder.file("a.exr"), b = folder.file("b.exr"),
                    whole = folder.file("w.exr"), out = folder.file("o.exr");
  const auto part = [](const std::string& file, const char* index) {
    render({"--scene", "boxes", "--device", "cpu", "--width", "40", "--height", "30", "--spp", "2",
            "--max-depth", "3", "--part", index, "--checkpoint", file});
  };
  part(a, "1/2"), part(b, "2/2"), part(whole, "1/1");
  printed([&] { merge_command({out, {a, b}, false, true}); });
  const PathTally found = read_checkpoint(out).film.tally,
                  expected = read_checkpoint(whole).film.tally;
  EXPECT_EQ(found.rays, expected.rays);
  EXPECT_EQ(found.shadow_rays, expected.shadow_rays);
  EXPECT_EQ(found.lengths[2], expected.lengths[2]);
  EXPECT_NE(found.rays, read_checkpoint(b).film.tally.rays);
  EXPECT_FALSE(read_checkpoint(out).metadata.contains("ptexp.option.part"));
  // Parts of different divisions have no common numbers: rows 0, 2, ... and 0, 3, ... of 30.
  part(b, "1/3");
  expect_error(
      [&] {
        merge_command({out, {a, b}});
      },
      "have 0 of 2 samples: 33.3 % of the samples are missing");
}

// Where a format has a place for radiance nothing is exposed; a scene of unknown brightness is
// measured for PNGs alone.
TEST(Exposures, OfFormatsAndWhatIsAskedFor) {
  using Kind = ExposureChoice::Kind;
  struct Case {
    const char* file;
    ExposureChoice choice;
    bool by_default;
    std::optional<float> stops;
    bool is_measured;
  };
  const float measured = std::log2(0.18f / 0.045f);
  const Case cases[] = {{"a.exr", {Kind::scene, 1.5f}, true, std::nullopt, false},
                        {"a.exr", {Kind::measured, 1.5f}, true, std::nullopt, false},
                        {"a.png", {Kind::scene, 1.5f}, true, measured, true},
                        {"a.png", {Kind::scene, 1.5f}, false, 1.5f, false},
                        {"a.ppm", {Kind::scene, 1.5f}, true, 1.5f, false},
                        {"a.ppm", {Kind::measured, 1.5f}, false, measured, true},
                        {"a.png", {Kind::measured, 1.5f}, false, measured, true},
                        {"a.png", {Kind::fixed, 1.5f}, true, 1.5f, false}};
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::Message() << c.file << ' ' << static_cast<int>(c.choice.kind));
    const auto found = exposure_for(c.file, c.choice, grey(0.045f), c.by_default);
    ASSERT_EQ(found.has_value(), c.stops.has_value());
    if (!found) continue;
    EXPECT_NEAR(found->stops, *c.stops, 1e-5);
    EXPECT_EQ(found->is_measured, c.is_measured);
  }
}

// A part of an image may well be black.
TEST(Exposures, ABlackImageIsSaidSo) {
  const auto is_said = [](float value, auto&& change) {
    Options options;
    change(options);
    return !black_image_text(options, grey(value)).empty();
  };
  const auto nothing = [](Options&) {};
  EXPECT_TRUE(is_said(0, nothing));
  EXPECT_TRUE(is_said(9e-7f, nothing));
  EXPECT_FALSE(is_said(1.1e-6f, nothing));
  EXPECT_FALSE(is_said(NAN, nothing));
  EXPECT_FALSE(is_said(0, [](Options& o) { o.quiet = true; }));
  EXPECT_FALSE(is_said(0, [](Options& o) { o.part = {1, 2}; }));
  EXPECT_TRUE(is_said(0, [](Options& o) { o.part = {1, 1}; }));
  EXPECT_FALSE(is_said(0, [](Options& o) { find_option("crop").set(o, "0,0,5,5"); }));
}

// Which file has which value; what no sample depends on may differ.
TEST(FilmHeaders, NameWhatDiffersAndWhere) {
  Options options;
  options.seed = 7, options.exposure = {ExposureChoice::Kind::fixed, 1.5f};
  const ImageMetadata a = film_header(options, "abc", "cpu");
  const auto refusal = [&](const char* key, const char* value) -> std::string {
    ImageMetadata b = a;
    b[key] = value;
    if (b[key].empty()) b.erase(key);
    try {
      check_same_render(a, "a.exr", b, "b.exr");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const std::string end = "; expected films of one render";
  EXPECT_EQ(refusal("ptexp.option.seed", "8"), "b.exr: --seed 8, but a.exr has 7" + end);
  EXPECT_EQ(refusal("ptexp.option.fov", "20"), "b.exr: --fov 20, but a.exr has none" + end);
  EXPECT_EQ(refusal("ptexp.scene_hash", ""), "b.exr: scene hash none, but a.exr has abc" + end);
  EXPECT_EQ(refusal("ptexp.device_kind", "cuda"),
            "b.exr: device kind cuda, but a.exr has cpu" + end);
  EXPECT_EQ(refusal("ptexp.film_version", "0"),
            "b.exr: ptexp.film_version 0, but a.exr has 1" + end);
  for (const char* other : {"exposure", "spp", "threads", "strict", "output", "mode"}) {
    EXPECT_EQ(refusal((std::string("ptexp.option.") + other).c_str(), "8"), "");
  }
  ImageMetadata optix = a;
  optix["ptexp.option.accel"] = "optix", optix["ptexp.option.optix_hits"] = "custom";
  check_same_render(a, "a.exr", optix, "o.exr");
  optix["ptexp.option.optix_hits"] = "built-in";
  expect_error([&] { check_same_render(a, "a.exr", optix, "o.exr"); },
               "o.exr: --accel optix --optix-hits built-in, but a.exr has other hits" + end);
  ImageMetadata old = a;
  old["ptexp.film_version"] = "0", old["ptexp.version"] = "0.0.3";
  expect_error([&] { options_in_header(old, "o.exr"); },
               "o.exr: ptexp.film_version 0, of ptexp 0.0.3; this program, " +
                   build_info().version + ", has 1 and gives other bits");
  ImageMetadata former = a;
  former["ptexp.option.shade"] = "material";
  former["ptexp.option.display"] = "localhost:14158";
  EXPECT_EQ(film_header(options_in_header(former, "f.exr"), "abc", "cpu"), a);
  former["ptexp.option.shades"] = "material";
  expect_error([&] { options_in_header(former, "f.exr"); },
               "f.exr: ptexp.option.shades: this program has no such option");
  Options changed = options_in_header(a, "a.exr");
  EXPECT_EQ(film_header(changed, "abc", "cpu"), a);
  apply_settings({{&find_option("seed"), "7"}, {&find_option("spp"), "9"}}, "a.exr", changed);
  EXPECT_EQ(changed.spp, 9);
  expect_error(
      [&] {
        apply_settings({{&find_option("seed"), "8"}}, "a.exr", changed);
      },
      "--seed 8: a.exr was begun with 7, and its samples are of that; expected the same, "
      "or a new render");
}

TEST(Attempts, AreAllMade) {
  Attempts attempts;
  int made = 0;
  EXPECT_TRUE(attempts.make([&] { ++made; }));
  attempts.check();
  EXPECT_FALSE(attempts.make([&] { throw Error("the first"); }, "; advice"));
  EXPECT_FALSE(attempts.make([&] { throw std::bad_alloc(); }));
  EXPECT_TRUE(attempts.make([&] { ++made; }));
  EXPECT_EQ(made, 2);
  expect_error([&] { attempts.check(); }, "the first; advice; not enough host memory");
}

}  // namespace
}  // namespace pt
