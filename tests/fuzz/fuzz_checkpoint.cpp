#include "common/film/checkpoint.h"
#include "common/film/develop.h"
#include "fuzz.h"
#include "fuzz_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pt::FuzzFolder folder;
  const auto path = folder.write("input.exr", pt::as_bytes(data, size));
  pt::expect_result_or_error([&] {
    const pt::Checkpoint checkpoint = pt::read_checkpoint(path.string());
    const pt::ImageFilm& film = checkpoint.film;
    if (!film.have(film.plan, film.window.pixel_count())) std::abort();
    for (const pt::FilmPart& part : film.parts) film.take(part.window);
    pt::develop(film, {});
  });
  return 0;
}
