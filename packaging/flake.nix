{
  # nix build ./packaging#neurotouch-hid; the libraries are those of nixpkgs.
  description = "A soft gel seen by an event camera, as a standard game controller";

  inputs.nixpkgs.url = "github:NixOS/nixpkgs/nixos-unstable";

  outputs = { self, nixpkgs }:
    let
      pkgs = nixpkgs.legacyPackages.x86_64-linux;
      python = pkgs.python3Packages;
    in
    {
      packages.x86_64-linux = rec {
        default = neurotouch-hid;
        neurotouch-hid = python.buildPythonApplication {
          pname = "neurotouch-hid";
          version = "0.1.0";
          pyproject = true;
          src = ./..;
          build-system = [ python.hatchling ];
          # nixpkgs builds these two from source, under the names of the sources.
          pythonRemoveDeps = [ "evdev-binary" "opencv-contrib-python-headless" ];
          pythonRelaxDeps = true;
          dependencies = [
            python.click
            python.evdev
            python.hidapi
            python.libusb1
            python.lz4
            python.matplotlib
            python.numba
            python.numpy
            python.opencv4
            python.packaging
            python.pydantic
            python.pyusb
            python.ruamel-yaml
            python.websockets
          ] ++ pkgs.lib.optional (python.pythonOlder "3.14") python.backports-zstd;
          # The tests need a checkout with its tools; here only that the program starts.
          pythonImportsCheck = [ "neurotouch_hid" ];
          # The service's rules and units name the paths of Debian: under NixOS, take the rules of
          # 'neurotouch setup' into the configuration.
        };
      };
    };
}
