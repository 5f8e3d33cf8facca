# Decides whether the CUDA device is built (PTEXP_CUDA) and with which flags.
set(PTEXP_CUDA_FOUND FALSE)
if(NOT PTEXP_CUDA STREQUAL "OFF")
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    # A GPU in this machine is the target; without one, PTX that every GPU since Turing can load.
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      execute_process(COMMAND nvidia-smi -L RESULT_VARIABLE no_gpu OUTPUT_QUIET ERROR_QUIET)
      if(no_gpu EQUAL 0)
        set(CMAKE_CUDA_ARCHITECTURES native)
      else()
        set(CMAKE_CUDA_ARCHITECTURES 75-virtual)
      endif()
    endif()
    enable_language(CUDA)
    find_package(CUDAToolkit REQUIRED)
    if(CUDAToolkit_VERSION VERSION_LESS 12.4)
      set(cuda_problem "CUDA ${CUDAToolkit_VERSION} is too old: conditional graph nodes need 12.4")
    else()
      set(PTEXP_CUDA_FOUND TRUE)
    endif()
  else()
    set(cuda_problem "no CUDA compiler (nvcc) was found")
  endif()
  if(NOT PTEXP_CUDA_FOUND)
    if(PTEXP_CUDA STREQUAL "ON")
      message(FATAL_ERROR "PTEXP_CUDA=ON, but ${cuda_problem}")
    endif()
    message(STATUS "Building for the CPU only: ${cuda_problem}")
  endif()
endif()

if(PTEXP_CUDA_FOUND)
  # Headers only: --counters loads CUPTI's library when it is asked for. Some toolkits have them in
  # a folder of their own.
  find_path(PTEXP_CUPTI_INCLUDE cupti_range_profiler.h
            HINTS ${CUDAToolkit_INCLUDE_DIRS} ${CUDAToolkit_LIBRARY_ROOT}/extras/CUPTI/include)
  message(STATUS "Building for the CPU and CUDA (architectures: ${CMAKE_CUDA_ARCHITECTURES})")
  if(NOT DEFINED CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 does not know nvcc's
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
  endif()
  set(CMAKE_CUDA_STANDARD 20)
  set(CMAKE_CUDA_STANDARD_REQUIRED ON)
  set(CMAKE_CUDA_EXTENSIONS OFF)
  add_library(ptexp_cuda_flags INTERFACE)
  # Most of the program is code for GPUs, a third as large so; drivers before CUDA 12.4 cannot
  # unpack it.
  set(compression)
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.8)
    set(compression --compress-mode=size)
  endif()
  # 20012: GLM 0.9.9 marks defaulted members __host__ __device__. Without --fmad=false each compiler
  # (ptxas, OptiX's) contracts what it likes: docs/design/bit_equality.md, 'Rounding'.
  target_compile_options(ptexp_cuda_flags INTERFACE
    $<$<COMPILE_LANGUAGE:CUDA>:--expt-relaxed-constexpr --diag-suppress=20012
    ${compression} -Xcompiler=-Wall,-Wno-unknown-pragmas,-ffp-contract=off>
    $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${PTEXP_LINEINFO}>>:-lineinfo>
    $<$<AND:$<COMPILE_LANGUAGE:CUDA>,$<BOOL:${PTEXP_WERROR}>>:-Werror=all-warnings>
    $<$<COMPILE_LANGUAGE:CUDA>:$<IF:$<BOOL:${PTEXP_FAST_MATH}>,--use_fast_math,--fmad=false>>)
endif()
