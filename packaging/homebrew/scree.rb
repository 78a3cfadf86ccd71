class Scree < Formula
  desc "From a 3D scan to the particle that a discrete-element simulation needs"
  homepage "FILL-IN-REPOSITORY"
  url "FILL-IN-REPOSITORY/releases/download/v0.2.0/scree-0.2.0-src.tar.gz"
  sha256 "FILL-IN-SHA256"
  license "MIT"

  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "pkgconf" => :build
  depends_on "cairo"
  depends_on "embree"
  depends_on "expat"
  depends_on "libyaml"
  depends_on "meshoptimizer"
  depends_on "qhull"
  depends_on "sqlite"
  depends_on "xxhash"

  uses_from_macos "zlib"

  def install
    system "cmake", "-G", "Ninja", "-S", ".", "-B", "build", "-DBUILD_TESTING=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"scree", "choose", "sample:dc-1", "--resolution", "2mm", "-o", "result"
    assert_predicate testpath/"result/report.html", :exist?
  end
end
