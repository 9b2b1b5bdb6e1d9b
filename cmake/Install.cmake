# What `cmake --install BUILD --component NAME --prefix PREFIX` puts where:
#   runtime  the programs, the point-based plugin, that of the methods that studies compare with, the resources, the
#            documentation, and the licences of all that is linked
#   embed    libc3de with c3de/embed.h, the target c3de::embed, c3de-embed.pc, and the Python package; needs runtime
#   sdk      headers of the plugin boundary and of its C++ comfort, the CMake package C3DE, a pkg-config file, examples
#   reference  the documentation as a site, with the Python package and the C headers (Reference.cmake)
#   pointbased  the point-based core to link into programs of others: static library and headers; needs sdk for the package
# ./run builds all that these components install (C3DE_PRODUCTS). Components whose name begins with package_ contain parts of these
# once more, for packages that are split otherwise (Packages.cmake); installing everything leaves them out.
# The target `uninstall` removes what was installed.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
include(Licences)
include(WindowsResources)

# The target `products` is what ./run builds: all that is installed, and the examples that guide and scenes name.
# products.txt lists their files for tests/scripts/documented_commands.sh.
set(C3DE_PRODUCTS c3de c3de_embed c3de_workstation c3de_window c3de_study_mpi c3de_validate pointbased c3de_pointbased_core baselines
  hello clamp magnet mass_spring material_law mesh_reader image_samples)
add_custom_target(products)
set(files "")
add_dependencies(products c3de_python)
foreach(product IN LISTS C3DE_PRODUCTS)
  if(TARGET ${product})
    add_dependencies(products ${product})
    string(APPEND files "$<TARGET_FILE:${product}>\n")
  endif()
endforeach()
if(NOT WIN32)
  string(APPEND files "$<TARGET_SONAME_FILE:c3de_embed>\n$<TARGET_LINKER_FILE:c3de_embed>\n")
endif()
file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/products$<$<BOOL:${CMAKE_CONFIGURATION_TYPES}>:-$<CONFIG>>.txt" CONTENT "${files}")

# Installed programs and libraries find libraries beside them, in lib, wherever the folder is moved to. DT_RPATH instead of
# DT_RUNPATH: it holds for the libraries of those libraries as well (archive of Packages.cmake).
if(UNIX AND NOT APPLE)
  foreach(product IN LISTS C3DE_PRODUCTS)
    if(TARGET ${product})
      get_target_property(type ${product} TYPE)
      if(NOT type STREQUAL "STATIC_LIBRARY")
        target_link_options(${product} PRIVATE -Wl,--disable-new-dtags)
        set_target_properties(${product} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
      endif()
    endif()
  endforeach()
  foreach(plugin pointbased baselines)
    if(TARGET ${plugin})
      set_target_properties(${plugin} PROPERTIES INSTALL_RPATH "$ORIGIN/../..")
    endif()
  endforeach()
  set_target_properties(c3de_embed PROPERTIES INSTALL_RPATH "$ORIGIN")
endif()

c3de_windows_resources(c3de "C3DE, commands")
c3de_windows_resources(c3de_workstation "C3DE, windows and pictures")
c3de_windows_resources(c3de_window "C3DE")
c3de_windows_resources(c3de_validate "C3DE, checks of plugins")
c3de_windows_resources(pointbased "C3DE, point-based plugin")
c3de_windows_resources(baselines "C3DE, methods that studies compare with")

# c3de_require_built(COMPONENT TARGET…)   what is installed next: where a file of it is missing, one message says what to type.
function(c3de_require_built component)
  set(files "")
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      string(APPEND files " \"$<TARGET_FILE:${target}>\"")
    endif()
  endforeach()
  file(RELATIVE_PATH build "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}")
  install(CODE "foreach(file IN ITEMS${files})
    if(NOT EXISTS \"\${file}\")
      cmake_path(GET file FILENAME name)
      message(FATAL_ERROR \" component ${component}: \${name} is not built; type: cmake --build ${build} --target products\")
    endif()
  endforeach()" COMPONENT ${component})
endfunction()

c3de_require_built(runtime c3de c3de_validate c3de_workstation c3de_window c3de_study_mpi pointbased baselines)
install(TARGETS c3de c3de_validate RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
if(TARGET c3de_workstation)
  install(TARGETS c3de_workstation RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
endif()
if(TARGET c3de_window)
  install(TARGETS c3de_window RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
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
include(Desktop)

# The folder has the layout of the source tree, so that links between pages hold.
set(documents share/doc/c3de)
foreach(component runtime sdk pointbased embed)
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/NOTICE" DESTINATION ${documents} COMPONENT ${component})
endforeach()
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md" DESTINATION ${documents} COMPONENT runtime)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs" DESTINATION ${documents} COMPONENT runtime)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/plugin" DESTINATION ${documents}/docs COMPONENT sdk)
c3de_install_licences(runtime ${documents}/licences)
c3de_install_licences(pointbased ${documents}/licences eigen nanoflann meshoptimizer highway expected)

c3de_require_built(embed c3de_embed)
# In lib, whatever the machine calls its own folder of libraries: plugins and resources are found relative to it.
install(TARGETS c3de_embed EXPORT C3DEEmbed LIBRARY DESTINATION lib COMPONENT embed RUNTIME DESTINATION lib COMPONENT embed
  ARCHIVE DESTINATION lib COMPONENT embed FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT embed)
install(FILES "${PROJECT_SOURCE_DIR}/framework/abi/include/c3de/abi/base.h"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/c3de/abi" COMPONENT embed)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/framework/embed/python/c3de" DESTINATION lib/python3/dist-packages COMPONENT embed
  FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)

set_target_properties(c3de_abi PROPERTIES EXPORT_NAME abi)
set_target_properties(c3de_sdk PROPERTIES EXPORT_NAME sdk)
install(TARGETS c3de_abi c3de_sdk c3de_pointbased_abi EXPORT C3DEPluginSDK
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT sdk)
set(package "${CMAKE_INSTALL_LIBDIR}/cmake/C3DE")
install(EXPORT C3DEPluginSDK NAMESPACE c3de:: DESTINATION "${package}" COMPONENT sdk)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/C3DEConfig.cmake.in" "${PROJECT_BINARY_DIR}/C3DEConfig.cmake"
  INSTALL_DESTINATION "${package}")
# The plugin boundary is frozen: a later package serves whoever asks for an earlier one. The host that loads a plugin need
# not be of the version of its headers: the boundary negotiates.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/C3DEConfigVersion.cmake" COMPATIBILITY AnyNewerVersion
  ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/C3DEConfig.cmake" "${PROJECT_BINARY_DIR}/C3DEConfigVersion.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/AddPlugin.cmake" "${CMAKE_CURRENT_LIST_DIR}/plugin.version"
  DESTINATION "${package}" COMPONENT sdk)
install(EXPORT C3DEEmbed NAMESPACE c3de:: DESTINATION "${package}" COMPONENT embed)
install(FILES "${PROJECT_BINARY_DIR}/C3DEConfig.cmake" "${PROJECT_BINARY_DIR}/C3DEConfigVersion.cmake"
  DESTINATION "${package}" COMPONENT embed)
c3de_require_built(pointbased c3de_pointbased_core)
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
configure_file("${CMAKE_CURRENT_LIST_DIR}/c3de-embed.pc.in" "${PROJECT_BINARY_DIR}/c3de-embed.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/c3de-embed.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT embed)
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

# Removes the files of install_manifest*.txt, which `cmake --install` has left in the build folder, and folders that are empty then.
add_custom_target(uninstall
  COMMAND "${CMAKE_COMMAND}" "-DBUILD=${PROJECT_BINARY_DIR}" -P "${CMAKE_CURRENT_LIST_DIR}/packages/uninstall.cmake" VERBATIM)
include(Packages)
