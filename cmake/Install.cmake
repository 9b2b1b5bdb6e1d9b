# What `cmake --install BUILD --component NAME --prefix PREFIX` puts where:
#   runtime  the programs, the point-based plugin, that of the methods that studies compare with, and the resources
#   sdk      headers of the plugin boundary and of its C++ comfort, the CMake package C3DE, a pkg-config file, examples
#   pointbased  the point-based core to link into programs of others: static library and headers; needs sdk for the package
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

install(TARGETS c3de c3de_validate RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
if(TARGET c3de_workstation)
  install(TARGETS c3de_workstation RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
endif()
if(TARGET c3de_study_mpi)
  install(TARGETS c3de_study_mpi RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
endif()
# Both are looked for relative to the program.
if(TARGET pointbased)
  install(TARGETS pointbased LIBRARY DESTINATION lib/c3de/plugins COMPONENT runtime
                             RUNTIME DESTINATION lib/c3de/plugins COMPONENT runtime)
endif()
if(TARGET baselines)
  install(TARGETS baselines LIBRARY DESTINATION lib/c3de/study COMPONENT runtime
                            RUNTIME DESTINATION lib/c3de/study COMPONENT runtime)
endif()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/resources/" DESTINATION share/c3de COMPONENT runtime)

set_target_properties(c3de_abi PROPERTIES EXPORT_NAME abi)
set_target_properties(c3de_sdk PROPERTIES EXPORT_NAME sdk)
install(TARGETS c3de_abi c3de_sdk c3de_pointbased_abi EXPORT C3DEPluginSDK
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT sdk)
set(package "${CMAKE_INSTALL_LIBDIR}/cmake/C3DE")
install(EXPORT C3DEPluginSDK NAMESPACE c3de:: DESTINATION "${package}" COMPONENT sdk)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/C3DEConfig.cmake.in" "${PROJECT_BINARY_DIR}/C3DEConfig.cmake"
  INSTALL_DESTINATION "${package}")
# Headers of a package and the host that loads its plugins need not be of one version: the boundary negotiates.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/C3DEConfigVersion.cmake" COMPATIBILITY SameMinorVersion
  ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/C3DEConfig.cmake" "${PROJECT_BINARY_DIR}/C3DEConfigVersion.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/AddPlugin.cmake" "${CMAKE_CURRENT_LIST_DIR}/plugin.version"
  DESTINATION "${package}" COMPONENT sdk)
set_target_properties(c3de_pointbased_core PROPERTIES EXPORT_NAME pointbased OUTPUT_NAME c3de_pointbased)
install(TARGETS c3de_pointbased_core EXPORT C3DEPointBased
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT pointbased
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT pointbased)
install(EXPORT C3DEPointBased NAMESPACE c3de:: DESTINATION "${package}" COMPONENT pointbased)
# From the folder of the .pc files to the prefix, wherever that is moved to.
file(RELATIVE_PATH up "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" /prefix)
configure_file("${CMAKE_CURRENT_LIST_DIR}/c3de-pointbased.pc.in" "${PROJECT_BINARY_DIR}/c3de-pointbased.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/c3de-pointbased.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
  COMPONENT pointbased)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples/batch" DESTINATION share/c3de/examples COMPONENT pointbased)
configure_file("${CMAKE_CURRENT_LIST_DIR}/c3de-sdk.pc.in" "${PROJECT_BINARY_DIR}/c3de-sdk.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/c3de-sdk.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT sdk)
install(FILES "${PROJECT_SOURCE_DIR}/plugins/hello/hello.c" "${PROJECT_SOURCE_DIR}/plugins/hello/greeter.h"
  "${PROJECT_SOURCE_DIR}/plugins/clamp/clamp.cpp" "${PROJECT_SOURCE_DIR}/plugins/magnet/magnet.cpp" "${PROJECT_SOURCE_DIR}/plugins/mesh_reader/mesh_reader.cpp"
  "${PROJECT_SOURCE_DIR}/plugins/image_samples/image_samples.cpp"
  "${PROJECT_SOURCE_DIR}/plugins/material_law/material_law.cpp" "${PROJECT_SOURCE_DIR}/plugins/mesh_reader/FORMAT.md"
  "${PROJECT_SOURCE_DIR}/docs/plugin/snippets/minimal.c" "${PROJECT_SOURCE_DIR}/docs/plugin/snippets/probe.cpp"
  "${PROJECT_SOURCE_DIR}/docs/plugin/snippets/phyxels.cpp"
  "${PROJECT_SOURCE_DIR}/docs/plugin/snippets/CMakeLists.txt"
  DESTINATION share/c3de/examples COMPONENT sdk)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/plugins/mass_spring" DESTINATION share/c3de/examples COMPONENT sdk
  FILES_MATCHING PATTERN "*.cpp" PATTERN "*.h")
