"""Melting and freezing of lattice sites, and what follows for links, regions and their sums."""


def build_lattice(do):
    """Fill regions and sums for the first time (every site is dirty)."""
    _refill(do)
    do.components()


def melt_and_relink(do):
    """Melt what is exposed and hot, one layer at most (line 9), and mend the lattice (line 10).

    Returns whether anything melted: volumes change with it. Reads that back once, and once more where
    crumbs melt too.
    """
    do.melt_test()
    melted = int(do.read("melted").sum())
    do.clock.melted += melted
    if melted == 0:
        return False
    _take_out(do)
    if do.settings.crumb > 0:
        do.crumble(smallest=do.settings.crumb)
        crumbs = int(do.read("melted").sum())
        if crumbs > 0:
            _take_out(do)
        do.clock.melted += crumbs
    return True


def _take_out(do):
    """Make liquid of the melting sites' particles and take the sites out of links and regions."""
    do.melt_particles()
    do.mark_dirty()  # on the regions as they were
    do.unlink()
    _refill(do)
    do.components()


def _refill(do):
    """Renew regions that are dirty, then the shares and sums that changed with them."""
    do.fill_regions()
    do.region_share()
    do.region_rest()
    if do.settings.solid_volume == "rest":
        do.rest_sum()


def freeze(do, dt):
    """Let cold liquid particles take vacant sites beside their bodies, or start bodies (spec 3.4).

    Sites are where the bodies stand now: c_r + R_r (X0 - c0_r) of a live neighbour site. Returns
    whether something froze: it stands on its site then, so neighbours must be searched again.
    Reads back once whether a site was claimed, and once more with nucleation.
    """
    do.region_match()
    do.freeze_choice(dt=dt)
    do.freeze_claim()
    frozen = int(do.read("frozen").sum())
    if do.need.nucleation:
        do.nucleus_choice()
        do.nucleus_claim()
        frozen += int(do.read("nucleated").sum())
    do.clock.frozen += frozen
    if frozen == 0:
        return False
    do.freeze_particles()
    do.freeze_sites()
    do.mark_frozen()
    _refill(do)
    do.components()
    return True
