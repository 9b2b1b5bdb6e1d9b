# `cpack --preset deb` and `cpack --preset tgz` write packages of what `./run` has built into build/packages; tools/package.sh does both.
# For Windows: WindowsPackages.cmake.
#
#   c3de_VERSION_ARCH.deb       program, plugins, libc3de, resources, guide, desktop files, man pages, completion
#   c3de-mpi_VERSION_ARCH.deb   c3de-study-mpi, which needs Open MPI
#   c3de-dev_VERSION_ARCH.deb   SDK of plugins, c3de/embed.h, the point-based core, CMake package, pkg-config files
#   python3-c3de_VERSION_all.deb
#   c3de-VERSION-linux-ARCH.tar.gz   all of it for any folder, with the libraries that a system with glibc 2.36 may lack
#
# Packages split components of Install.cmake further, which the components package_… do: each file is in one package.
set(C3DE_MAINTAINER "The C3DE authors <c3de@example.org>" CACHE STRING "Maintainer of the packages, \"NAME <ADDRESS>\"")
if(WIN32)
  include(WindowsPackages)
  return()
endif()

# --- parts of components once more --------------------------------------------------------------------------------------------
install(TARGETS c3de_embed LIBRARY DESTINATION lib COMPONENT package_library NAMELINK_SKIP EXCLUDE_FROM_ALL)
install(TARGETS c3de_embed LIBRARY DESTINATION lib COMPONENT package_embed NAMELINK_ONLY EXCLUDE_FROM_ALL)
install(FILES "${PROJECT_SOURCE_DIR}/framework/embed/include/c3de/embed.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/c3de"
  COMPONENT package_embed EXCLUDE_FROM_ALL)
install(EXPORT C3DEEmbed NAMESPACE c3de:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/C3DE" COMPONENT package_embed EXCLUDE_FROM_ALL)
install(FILES "${PROJECT_BINARY_DIR}/c3de-embed.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT package_embed
  EXCLUDE_FROM_ALL)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/framework/embed/python/c3de" DESTINATION lib/python3/dist-packages COMPONENT package_python
  EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
if(TARGET c3de_study_mpi)
  install(TARGETS c3de_study_mpi RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT package_mpi EXCLUDE_FROM_ALL)
endif()

# --- libraries inside the archive ---------------------------------------------------------------------------------------------
# Not those of the C and C++ runtime: drivers of the system are loaded into the same process and need its own, newer ones. Nor
# those that belong to the display and its driver.
set(C3DE_LIBRARIES_OF_THE_SYSTEM
  "^(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|stdc\\+\\+|gcc_s)\\.so.*)$"
  "^lib(GL|EGL|GLX|GLdispatch|OpenGL|GLU|drm|gbm|vulkan)\\.so.*$"
  "^lib(X11|X11-xcb|xcb|xcb-.*|Xau|Xdmcp|Xext|Xi|Xrandr|Xcursor|Xinerama|wayland-.*)\\.so.*$")
set(executables "")
set(modules "")
foreach(target c3de c3de_workstation c3de_validate)
  if(TARGET ${target})
    string(APPEND executables " \"$<TARGET_FILE:${target}>\"")
  endif()
endforeach()
foreach(target pointbased baselines c3de_embed)
  if(TARGET ${target})
    string(APPEND modules " \"$<TARGET_FILE:${target}>\"")
  endif()
endforeach()
string(REPLACE ";" "\" \"" exclude "${C3DE_LIBRARIES_OF_THE_SYSTEM}")
string(REPLACE "\\" "\\\\" exclude "${exclude}")
install(CODE "set(executables ${executables})\nset(modules ${modules})\nset(exclude \"${exclude}\")
include(\"${CMAKE_CURRENT_LIST_DIR}/packages/bundle_libraries.cmake\")" COMPONENT package_libraries EXCLUDE_FROM_ALL)

# --- what cpack reads ---------------------------------------------------------------------------------------------------------
set(CPACK_PACKAGE_NAME c3de)
set(CPACK_PACKAGE_VENDOR "The C3DE authors")
set(CPACK_PACKAGE_CONTACT "${C3DE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulates how soft tissue of medical scans deforms")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_SOURCE_DIR}/build/packages")
set(CPACK_OUTPUT_CONFIG_FILE "${PROJECT_BINARY_DIR}/CPackConfig.cmake")
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_THREADS 0)
set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_CURRENT_LIST_DIR}/packages/cpack_project.cmake")
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/packages/finish_packages.cmake")
set(CPACK_C3DE_FILES "${CMAKE_CURRENT_LIST_DIR}/packages")
set(CPACK_C3DE_BUILD "${PROJECT_BINARY_DIR}")
set(CPACK_C3DE_RELEASE_TIME "${C3DE_RELEASE_TIME}")
set(CPACK_C3DE_RELEASE_EPOCH "${C3DE_RELEASE_EPOCH}")
set(CPACK_C3DE_GZIP "${C3DE_GZIP}")

set(CPACK_COMPONENTS_ALL runtime package_library sdk pointbased package_embed package_python)
set(CPACK_COMPONENT_RUNTIME_GROUP program)
set(CPACK_COMPONENT_PACKAGE_LIBRARY_GROUP program)
set(CPACK_COMPONENT_SDK_GROUP development)
set(CPACK_COMPONENT_POINTBASED_GROUP development)
set(CPACK_COMPONENT_PACKAGE_EMBED_GROUP development)
set(CPACK_COMPONENT_PACKAGE_PYTHON_GROUP python)
if(TARGET c3de_study_mpi)
  list(APPEND CPACK_COMPONENTS_ALL package_mpi)
  set(CPACK_COMPONENT_PACKAGE_MPI_GROUP mpi)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${C3DE_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(same "(= ${PROJECT_VERSION})")
set(about "C3DE shows medical images and surface meshes and simulates how soft tissue
in them deforms. A label of a scan becomes a deformable body without meshing,
and the scan deforms with it. Simulations come from plugins; the point-based
one is included. Not for clinical use.")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME c3de)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# libepoxy loads the OpenGL libraries while the program runs, and text in pictures is drawn with a font of the system.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core, libegl1, libgl1")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri, mricron-data")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "c3de-mpi, ffmpeg, python3-c3de")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_LIST_DIR}/packages/program/triggers")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "workstation that simulates how tissue of medical scans deforms
${about}
.
This package has the program, its plugins, the library libc3de, example
scenes and the guide.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME c3de-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "c3de ${same}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake, libeigen3-dev, libexpected-dev, libhwy-dev, libmeshoptimizer-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "development files of C3DE: plugins, and simulations in other programs
${about}
.
This package has the headers for plugins in C and C++, the header of libc3de,
the point-based core as a static library, CMake packages, pkg-config files and
examples.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-c3de)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "c3de (>= ${PROJECT_VERSION}), python3:any (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-mpi4py, python3-nibabel")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_LIST_DIR}/packages/python/postinst"
  "${CMAKE_CURRENT_LIST_DIR}/packages/python/prerm")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "simulations of C3DE in Python
${about}
.
This package opens scenes in Python, runs them and gives fields and images as
numpy arrays.")

set(CPACK_DEBIAN_MPI_PACKAGE_NAME c3de-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "c3de ${same}")
set(CPACK_DEBIAN_MPI_PACKAGE_RECOMMENDS "openmpi-bin")
set(CPACK_DEBIAN_MPI_DESCRIPTION "studies of C3DE on several machines
${about}
.
This package has the program in which c3de study goes on under mpirun.")

include(CPack)
