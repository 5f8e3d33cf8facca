// Paths that carry extra records in registers (--path-bytes): a kernel for each number of them that
// the table of kernels has.
#include "megakernel/megakernel_launch.cuh"

namespace pt {
namespace {

template <int records>
constexpr bool is_in_table =
    detail::selected_count<
        KernelSelection<true, CarryingSource<records>, SceneMemory::global, KernelBody::loop>>() >
    0;

}  // namespace

void MegakernelCuda::launch_carrying(const SamplerSource& source, const SampleBuffer& batch) {
  const SceneStorage<SceneMemory::global> storage{scene_};
  bool is_launched = false;
  const auto launch_if = [&]<int records>(std::integral_constant<int, records>) {
    if constexpr (records > 0 && is_in_table<records>) {
      if (plan_.path_bytes != records * extra_record_bytes) return;
      launch_megakernel(storage, 0, CarryingSource<records>{source}, batch);
      is_launched = true;
    }
  };
  [&]<int... records>(std::integer_sequence<int, records...>) {
    (launch_if(std::integral_constant<int, records>{}), ...);
  }
  (std::make_integer_sequence<int, extra_records_max + 1>{});
  if (!is_launched) throw_no_kernel(traits_);
}

}  // namespace pt
