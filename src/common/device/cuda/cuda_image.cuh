// The memory of a DeviceImage.
#pragma once

#include <cuda_runtime_api.h>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/image/image.h"

namespace pt {

class CudaImage : public DeviceImage {
 public:
  /// In the memory of the current device. Throws Error.
  CudaImage(Image frame, int device)
      : DeviceImage(std::move(frame)),
        floats_(std::size_t{3} * this->frame().width * this->frame().height),
        rgb_(memory_.allocate<float>("image", floats_)),
        device_(device) {}
  ~CudaImage() override { reach_gpu(device_); }  // whose memory is freed

  float* rgb() const override { return rgb_; }
  int device() const override { return device_; }
  std::vector<float> download() const override {
    std::vector<float> rgb(floats_);
    reach_gpu(device_);
    check_cuda(cudaMemcpy(rgb.data(), rgb_, floats_ * sizeof(float), cudaMemcpyDeviceToHost),
               "downloading the image");
    return rgb;
  }

 private:
  CudaMemory memory_;
  std::size_t floats_;
  float* rgb_;
  int device_;
};

}  // namespace pt
