def api_pages(root):
    return []
