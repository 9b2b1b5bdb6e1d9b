# Included by Packages.cmake for Windows: `cpack --preset nsis` and `cpack --preset zip` write into build/packages, of what the preset
# windows-mingw has built,
#   c3de-VERSION-windows-ARCH.exe   an installer (NSIS): Start menu, files of sessions and recordings, removal
#   c3de-VERSION-windows-ARCH.zip   the same files for any folder
# Programs and plugins contain the libraries. Components: runtime, sdk, and the reference as a site where C3DE_REFERENCE_SITE has it.
set(C3DE_REFERENCE_SITE "" CACHE PATH "The target `reference` of another build, which the packages for Windows take along")
if(EXISTS "${C3DE_REFERENCE_SITE}/index.html")
  install(DIRECTORY "${C3DE_REFERENCE_SITE}/" DESTINATION share/doc/c3de/reference COMPONENT package_site EXCLUDE_FROM_ALL
    PATTERN ".buildinfo" EXCLUDE)
endif()

set(files "${CMAKE_CURRENT_LIST_DIR}/packages/windows")
set(CPACK_PACKAGE_NAME c3de)
set(CPACK_PACKAGE_VENDOR "C3DE")
set(CPACK_PACKAGE_CONTACT "${C3DE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulates how soft tissue of medical scans deforms")
set(CPACK_PACKAGE_FILE_NAME "c3de-${PROJECT_VERSION}-windows-x86_64")
set(CPACK_PACKAGE_INSTALL_DIRECTORY "C3DE")
set(CPACK_PACKAGE_INSTALL_REGISTRY_KEY "C3DE")
configure_file("${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_BINARY_DIR}/LICENSE.txt" COPYONLY)
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_BINARY_DIR}/LICENSE.txt")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_SOURCE_DIR}/build/packages")
set(CPACK_OUTPUT_CONFIG_FILE "${PROJECT_BINARY_DIR}/CPackConfig.cmake")
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_MONOLITHIC_INSTALL ON)
set(CPACK_INSTALL_CMAKE_PROJECTS "")
foreach(component runtime sdk package_site)
  list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR}" C3DE ${component} "/")
endforeach()
set(CPACK_PRE_BUILD_SCRIPTS "${files}/finish_packages.cmake")

set(CPACK_NSIS_PACKAGE_NAME "C3DE ${PROJECT_VERSION}")
set(CPACK_NSIS_DISPLAY_NAME "C3DE")
set(CPACK_NSIS_INSTALL_ROOT "$PROGRAMFILES64")
set(CPACK_NSIS_MUI_ICON "${files}/c3de.ico")
set(CPACK_NSIS_MUI_UNIICON "${files}/c3de.ico")
set(CPACK_NSIS_INSTALLED_ICON_NAME "bin\\c3de.exe")
set(CPACK_NSIS_CONTACT "${C3DE_MAINTAINER}")
set(CPACK_NSIS_ENABLE_UNINSTALL_BEFORE_INSTALL ON)
set(CPACK_NSIS_MODIFY_PATH ON)
set(CPACK_NSIS_MANIFEST_DPI_AWARE ON)
if(TARGET c3de_window)
  set(CPACK_PACKAGE_EXECUTABLES c3de-window C3DE)
  if(EXISTS "${C3DE_REFERENCE_SITE}/index.html")
    set(CPACK_NSIS_MENU_LINKS "share/doc/c3de/reference/index.html" "Guide")
  endif()
endif()
file(READ "${files}/associate.nsh" CPACK_NSIS_EXTRA_INSTALL_COMMANDS)
file(READ "${files}/dissociate.nsh" CPACK_NSIS_EXTRA_UNINSTALL_COMMANDS)
set(CPACK_NSIS_DELETE_ICONS_EXTRA "  DeleteRegKey /ifempty SHCTX \"Software\\${CPACK_PACKAGE_VENDOR}\"")
string(CONCAT CPACK_NSIS_DEFINES "VIProductVersion \"${PROJECT_VERSION}.0\"\n"
  "VIAddVersionKey \"ProductName\" \"C3DE\"\nVIAddVersionKey \"ProductVersion\" \"${PROJECT_VERSION}\"\n"
  "VIAddVersionKey \"FileDescription\" \"C3DE, installer\"\nVIAddVersionKey \"FileVersion\" \"${PROJECT_VERSION}\"\n"
  "VIAddVersionKey \"CompanyName\" \"The C3DE authors\"\nVIAddVersionKey \"LegalCopyright\" \"Apache License 2.0\"")
if(CMAKE_HOST_UNIX)
  # Debian's NSIS can write installers for 64 bits, which run where programs for 32 bits do not (wine64).
  set(CPACK_NSIS_EXECUTABLE "${PROJECT_SOURCE_DIR}/tools/windows/makensis.sh")
endif()
include(CPack)
