# Licence texts of the libraries that the programs and plugins link or are compiled with, taken from where the libraries
# come from: Debian keeps them in /usr/share/doc, vcpkg in share of its prefix. NOTICE names the same libraries.
# c3de_install_licences(COMPONENT FOLDER [NAME…]): of all, or of those named, into FOLDER/NAME.txt.

# name, Debian package, vcpkg port
set(C3DE_LIBRARIES
  "eigen libeigen3-dev eigen3" "fcl libfcl-dev fcl" "libccd libccd-dev ccd" "octomap liboctomap-dev octomap"
  "assimp libassimp-dev assimp" "tinyobjloader libtinyobjloader-dev tinyobjloader" "nanoflann libnanoflann-dev nanoflann"
  "meshoptimizer libmeshoptimizer-dev meshoptimizer" "highway libhwy-dev highway" "expected libexpected-dev tl-expected"
  "fmt libfmt-dev fmt" "spdlog libspdlog-dev spdlog" "tomlplusplus libtomlplusplus-dev tomlplusplus"
  "nlohmann-json nlohmann-json3-dev nlohmann-json" "gdcm libgdcm-dev gdcm" "zlib zlib1g-dev zlib"
  "minizip libminizip-dev minizip" "openssl libssl-dev openssl" "cli11 libcli11-dev cli11" "stb libstb-dev stb")
if(C3DE_BUILD_WINDOW)
  list(APPEND C3DE_LIBRARIES "glfw libglfw3-dev glfw3" "imgui libimgui-dev imgui" "libepoxy libepoxy-dev libepoxy")
endif()
if(OpenIGTLink_FOUND)
  list(APPEND C3DE_LIBRARIES "openigtlink libopenigtlink-dev openigtlink")
endif()
if(MPI_CXX_FOUND)
  list(APPEND C3DE_LIBRARIES "openmpi libopenmpi-dev openmpi")
endif()

if(MINGW)
  # Linked into programs and plugins for Windows: the runtime of the compiler.
  list(APPEND C3DE_LIBRARIES "gcc gcc-mingw-w64-base gcc" "mingw-w64 mingw-w64-common mingw-w64")
endif()

function(c3de_install_licences component folder)
  set(without "")
  foreach(library IN LISTS C3DE_LIBRARIES)
    separate_arguments(library)
    list(GET library 0 name)
    list(GET library 1 package)
    list(GET library 2 port)
    if(ARGN AND NOT name IN_LIST ARGN)
      continue()
    endif()
    set(C3DE_LICENCE_TEXT "C3DE_LICENCE_TEXT-NOTFOUND")
    find_file(C3DE_LICENCE_TEXT copyright NO_CACHE NO_PACKAGE_ROOT_PATH
      NO_CMAKE_FIND_ROOT_PATH PATHS "/usr/share/doc/${package}" PATH_SUFFIXES "share/${port}")
    if(C3DE_LICENCE_TEXT)
      # Debian's are links into other packages.
      file(REAL_PATH "${C3DE_LICENCE_TEXT}" text)
      install(FILES "${text}" DESTINATION "${folder}" RENAME "${name}.txt" COMPONENT ${component})
    else()
      list(APPEND without "${name}")
    endif()
  endforeach()
  if(without)
    list(JOIN without ", " without)
    message(STATUS "licence texts that were not found and are not installed (component ${component}): ${without}")
  endif()
  # What Debian's texts refer to.
  foreach(text IN ITEMS MPL-2.0 CC0-1.0)
    if(EXISTS "/usr/share/common-licenses/${text}")
      install(FILES "/usr/share/common-licenses/${text}" DESTINATION "${folder}" COMPONENT ${component})
    endif()
  endforeach()
endfunction()
