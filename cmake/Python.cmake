# The Python module ptexp._ptexp (PTEXP_PYTHON), by nanobind: of the Python that pip builds for, or
# of Python_EXECUTABLE, which needs the package nanobind.
# SKBUILD_SABI_COMPONENT: pip's, for a wheel that serves later Pythons as well (scripts/wheel).
find_package(Python 3.9 REQUIRED COMPONENTS Interpreter Development.Module
             ${SKBUILD_SABI_COMPONENT})
if(NOT DEFINED nanobind_DIR)
  execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir
                  OUTPUT_VARIABLE nanobind_found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(nanobind_found)
    set(nanobind_DIR ${nanobind_found})
  endif()
endif()
find_package(nanobind CONFIG REQUIRED)

# A package that works from the build folder, too: build/PRESET/python.
set(package ${PROJECT_BINARY_DIR}/python/ptexp)
file(GLOB python_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/ptexp/*.py
     ${PROJECT_SOURCE_DIR}/python/ptexp/py.typed)
file(GLOB module_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/python/*.cpp)
nanobind_add_module(_ptexp NB_STATIC NOMINSIZE STABLE_ABI ${module_sources})
# Nothing in these takes long, but their compilation would.
foreach(target _ptexp nanobind-static nanobind-static-abi3)
  if(TARGET ${target})
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endforeach()
target_include_directories(_ptexp SYSTEM PRIVATE ${NB_DIR}/include)  # no warnings from there
target_link_libraries(_ptexp PRIVATE ptexp_app)
ptexp_unite(_ptexp 16)
set_target_properties(_ptexp PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${package})
add_custom_command(OUTPUT ${package}/py.typed
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${python_sources} ${package}
  DEPENDS ${python_sources})
add_custom_target(ptexp_python_sources ALL DEPENDS ${package}/py.typed)
add_dependencies(_ptexp ptexp_python_sources)
nanobind_add_stub(ptexp_python_stub MODULE _ptexp OUTPUT ${package}/_ptexp.pyi
                  PYTHON_PATH ${package} DEPENDS _ptexp)
# Types of keywords, from the module's table of options.
add_custom_command(OUTPUT ${package}/_keywords.pyi
  COMMAND ${CMAKE_COMMAND} -E env PYTHONPATH=${PROJECT_BINARY_DIR}/python
          ${Python_EXECUTABLE} -m ptexp._stub ${package}/_keywords.pyi
  DEPENDS _ptexp ptexp_python_sources ${python_sources})
add_custom_target(ptexp_python_keywords ALL DEPENDS ${package}/_keywords.pyi)
install(FILES ${package}/_ptexp.pyi ${package}/_keywords.pyi DESTINATION ptexp COMPONENT python EXCLUDE_FROM_ALL)
install(TARGETS _ptexp LIBRARY DESTINATION ptexp COMPONENT python EXCLUDE_FROM_ALL)
