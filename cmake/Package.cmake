# `cpack -G DEB` (in the build folder) makes a package for the Debian or Ubuntu on which it runs: the
# component `program`, which needs the system's libraries rather than copies of them.
set(CPACK_PACKAGE_NAME ptexp)
set(CPACK_PACKAGE_VENDOR "The ptexp authors")
set(CPACK_PACKAGE_CONTACT "The ptexp authors")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)

set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME ptexp)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "path tracer for research on execution architectures")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION
    "Renders one image by a serial loop, a megakernel or a wavefront of small kernels,
on the CPU and on NVIDIA GPUs, and measures each.")
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_layout.cmake)
include(CPack)
