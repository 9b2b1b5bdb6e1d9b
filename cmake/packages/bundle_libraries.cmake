# Included by an installation for the archive: copies the shared libraries that `executables` and `modules` need into PREFIX/lib,
# without those that match `exclude`, and their licence texts into share/doc/c3de/licences. DT_RPATH of the programs finds them.
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${executables} MODULES ${modules}
  RESOLVED_DEPENDENCIES_VAR found UNRESOLVED_DEPENDENCIES_VAR missing
  PRE_EXCLUDE_REGEXES ${exclude})
if(missing)
  list(JOIN missing ", " missing)
  message(FATAL_ERROR "libraries that are not on this machine: ${missing}")
endif()
list(SORT found)
find_program(dpkg_query dpkg-query NO_CACHE)
foreach(library IN LISTS found)
  file(INSTALL "${library}" DESTINATION "${CMAKE_INSTALL_PREFIX}/lib" FOLLOW_SYMLINK_CHAIN TYPE SHARED_LIBRARY)
  file(REAL_PATH "${library}" real)
  set(package "")
  if(dpkg_query)
    execute_process(COMMAND "${dpkg_query}" -S "${real}" OUTPUT_VARIABLE owner ERROR_QUIET)
    if(NOT owner)
      # A system whose /lib is a link to /usr/lib lists some files below /lib.
      string(REGEX REPLACE "^/usr" "" real "${real}")
      execute_process(COMMAND "${dpkg_query}" -S "${real}" OUTPUT_VARIABLE owner ERROR_QUIET)
    endif()
    string(REGEX REPLACE "[:,].*" "" package "${owner}")
  endif()
  cmake_path(GET library FILENAME name)
  if(package AND EXISTS "/usr/share/doc/${package}/copyright")
    file(REAL_PATH "/usr/share/doc/${package}/copyright" text)
    file(INSTALL "${text}" DESTINATION "${CMAKE_INSTALL_PREFIX}/share/doc/c3de/licences" RENAME "${package}.txt")
  else()
    message(STATUS "the licence text of ${name} was not found and is not in the archive")
  endif()
endforeach()
# What the texts refer to.
foreach(text IN ITEMS Apache-2.0 LGPL-2 LGPL-2.1 LGPL-3 GPL-2 GPL-3 BSD Artistic)
  if(EXISTS "/usr/share/common-licenses/${text}")
    file(INSTALL "/usr/share/common-licenses/${text}" DESTINATION "${CMAKE_INSTALL_PREFIX}/share/doc/c3de/licences")
  endif()
endforeach()
# Letters of pictures and of the window, where the system has no font.
if(EXISTS /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf)
  file(INSTALL /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf /usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf
    DESTINATION "${CMAKE_INSTALL_PREFIX}/share/c3de/fonts")
  file(INSTALL /usr/share/doc/fonts-dejavu-core/copyright DESTINATION "${CMAKE_INSTALL_PREFIX}/share/doc/c3de/licences"
    RENAME fonts-dejavu-core.txt)
endif()
