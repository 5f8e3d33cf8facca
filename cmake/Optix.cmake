# Decides whether the modules for OptiX are built (PTEXP_OPTIX): that takes nvcc alone.
set(PTEXP_OPTIX_FOUND ${PTEXP_CUDA_FOUND})
if(PTEXP_OPTIX STREQUAL "OFF")
  set(PTEXP_OPTIX_FOUND FALSE)
elseif(PTEXP_OPTIX STREQUAL "ON" AND NOT PTEXP_CUDA_FOUND)
  message(FATAL_ERROR "PTEXP_OPTIX=ON needs the CUDA device (PTEXP_CUDA)")
endif()

# ptexp_optix_module(TARGET SOURCE): TARGET may include <optix/NAME.inc>, the PTX of SOURCE by gzip as a
# list of bytes, a single 0 where no modules are built. Every OptiX that ptexp knows takes code for compute
# capability 7.5.
function(ptexp_optix_module target source)
  cmake_path(GET source STEM name)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/optix/${name}.inc)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
  if(NOT PTEXP_OPTIX_FOUND)
    file(CONFIGURE OUTPUT ${output} CONTENT "0\n")
    return()
  endif()
  add_library(ptexp_${name} OBJECT ${source})
  set_target_properties(ptexp_${name} PROPERTIES CUDA_PTX_COMPILATION ON
                        CUDA_ARCHITECTURES 75-virtual)
  target_link_libraries(ptexp_${name} PRIVATE ptexp_flags)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DINPUT=$<TARGET_OBJECTS:ptexp_${name}> -DOUTPUT=${output}
            -P ${PROJECT_SOURCE_DIR}/cmake/optix_code.cmake
    DEPENDS ptexp_${name} $<TARGET_OBJECTS:ptexp_${name}> ${PROJECT_SOURCE_DIR}/cmake/optix_code.cmake
    VERBATIM)
  add_custom_target(ptexp_${name}_code DEPENDS ${output})
  add_dependencies(${target} ptexp_${name}_code)
endfunction()
