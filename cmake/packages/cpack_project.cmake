# Read by cpack for each generator.
if(CPACK_GENERATOR STREQUAL "DEB")
  set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
  # Each package has its own; cpack would put the common one above.
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
else()
  # One archive of everything, and the libraries.
  set(CPACK_COMPONENTS_ALL "")
  list(GET CPACK_INSTALL_CMAKE_PROJECTS 0 build)
  set(CPACK_INSTALL_CMAKE_PROJECTS "")
  foreach(component runtime embed sdk pointbased package_libraries)
    list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${build}" C3DE ${component} "/")
  endforeach()
  set(CPACK_MONOLITHIC_INSTALL ON)
  set(CPACK_INCLUDE_TOPLEVEL_DIRECTORY ON)
  string(TOLOWER "${CPACK_SYSTEM_NAME}" system)
  execute_process(COMMAND uname -m OUTPUT_VARIABLE machine OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(CPACK_PACKAGE_FILE_NAME "c3de-${CPACK_PACKAGE_VERSION}-${system}-${machine}")
endif()
# Files of a package have the date of the release.
set(ENV{SOURCE_DATE_EPOCH} "${CPACK_C3DE_RELEASE_EPOCH}")
# The installation of packages leaves its lists of files in the build folder; those of real installations are for `uninstall`.
set(kept "${CPACK_C3DE_BUILD}/CMakeFiles/kept_manifests")
file(GLOB manifests "${CPACK_C3DE_BUILD}/install_manifest*.txt")
file(REMOVE_RECURSE "${kept}")
if(manifests)
  file(COPY ${manifests} DESTINATION "${kept}")
endif()
